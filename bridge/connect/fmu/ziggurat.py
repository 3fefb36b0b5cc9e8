"""The tables of numpy's normal random numbers, as numba carries them."""

from bridge.connect.fmu.source import doubles, wholes


def tables() -> str:
    """ziggurat.h."""
    from numba.np.random import _constants as of

    return "\n".join(
        (
            f"#define ZIGGURAT_EDGE {float(of.ziggurat_nor_r).hex()}",
            f"#define ZIGGURAT_INVERSE {float(of.ziggurat_nor_inv_r).hex()}",
            "static " + wholes("ziggurat_inside", "256", of.ki_double.tolist(), "uint64_t", "u"),
            "static " + doubles("ziggurat_width", "256", of.wi_double.tolist()),
            "static " + doubles("ziggurat_height", "256", of.fi_double.tolist()),
        )
    )
