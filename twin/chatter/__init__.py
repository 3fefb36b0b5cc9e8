"""Why a relief valve sings: poppet, spring and a volume of oil before the seat, after chapter 4 of the thesis."""
