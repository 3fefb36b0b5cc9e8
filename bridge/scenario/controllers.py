"""The controllers a scenario can ask for, by `controller.kind`; each gives the numbers of its law in SI."""

import math
from typing import Annotated, Any, ClassVar, Literal

from pydantic import AfterValidator, BeforeValidator, ConfigDict, Field, model_validator

from bridge.errors import MisplacedError, nearest
from bridge.scenario.controller_base import Base, Scale, WithOverlap, WithVelocity
from bridge.scenario.controller_base import parameter_in_si as parameter_in_si
from bridge.scenario.fields import DerivativeGain, Fraction, IntegralGain, ProportionalGain, Seconds, by_kind
from bridge.scenario.fmu_controller import Fmu
from bridge.scenario.law_file import c_file, with_kind
from bridge.scenario.law_parameters import only_numbers, parameters_of
from bridge.scenario.state_space import FROM, READS, SAME, Matrix, Origin, Signal, refuse_matrices
from controller import law as laws
from controller.pid import BACK_CALCULATION, PidGains
from controller.state_space import StateSpaceGains


class WithGains(WithVelocity, WithOverlap):
    """A controller with proportional and derivative gain."""

    gain: ProportionalGain = Field(default="1.0 V/%", description="proportional, on the position error")
    derivative: DerivativeGain = Field(default="0.0 V s/%", description="on the piston's velocity")
    overlap_rest: Fraction = Field(
        default=0.0, ge=0.0, le=0.5, description="of the command, up to which a shut valve stays shut; 0: never"
    )

    @model_validator(mode="after")
    def _jumps(self) -> "WithGains":
        if self.overlap_rest > 0.0 and not self.compensate_overlap:
            raise MisplacedError("overlap_rest", "only a valve that jumps needs rest: set compensate_overlap = true")
        return self


class PdGains(WithGains):
    """A controller whose law is given the gains of `controller.law.pd`."""

    def gains(self, scale: Scale) -> laws.Gains | laws.UserGains:
        """The numbers of `controller.law.pd`."""
        return self._own(scale)

    def _own(self, scale: Scale) -> laws.Gains:
        return laws.Gains(
            proportional=scale.per_metre(self.gain),
            derivative=scale.per_metre(self.derivative),
            source=self.velocity,
            filter_time=self.filter_time,
            sample_period=scale.sample_period,
            limit=self.limit,
            overlap=self.jumped_share * scale.overlap,
            rest=self.overlap_rest,
        )


class Pd(PdGains):
    """In proportion to the error, less the piston's velocity."""

    kind: Literal["pd"] = "pd"


class Pid(WithGains):
    """PID whose integral does not wind up, with the reference's velocity fed forward."""

    kind: Literal["pid"]
    integral: IntegralGain = Field(default="0.0 V/(% s)", description="on the integral of the position error")
    feed_forward: DerivativeGain = Field(default="0.0 V s/%", description="on the reference's velocity")
    anti_windup: Literal["back-calculation", "clamping", "none"] = Field(
        default=BACK_CALCULATION, description="what keeps the integral from winding up at the limit"
    )
    tracking_time: Seconds = Field(default=0.0, ge=0.0, description="of back-calculation; 0: gain over integral gain")

    def gains(self, scale: Scale) -> PidGains:
        """The numbers of `controller.pid`."""
        numbers = {name: scale.per_metre(getattr(self, name)) for name in ("integral", "derivative", "feed_forward")}
        proportional = scale.per_metre(self.gain)
        return PidGains(
            proportional=proportional,
            **numbers,
            source=self.velocity,
            filter_time=self.filter_time,
            sample_period=scale.sample_period,
            limit=self.limit,
            overlap=self.jumped_share * scale.overlap,
            anti_windup=self.anti_windup,
            tracking_time=self._tracking(proportional, numbers["integral"], scale.sample_period),
            rest=self.overlap_rest,
        )

    def _tracking(self, proportional: float, integral: float, period: float) -> float:
        own = proportional / integral if integral > 0.0 else math.inf
        return max(self.tracking_time or own, period)

    def refuse_period(self, period: float) -> None:
        if 0.0 < self.tracking_time < period:
            raise ValueError(
                f"controller.tracking_time {self.tracking_time:g} s must be at least loop.sample_period, {period:g} s: "
                "a shorter one would overshoot"
            )


class Relay(WithVelocity):
    """The whole limit in the direction of (x_ref - x) - derivative_time * velocity."""

    kind: Literal["relay"]
    derivative_time: Seconds = Field(default=0.0, ge=0.0, description="lead of the switching line")

    def gains(self, scale: Scale) -> laws.RelayGains:
        """The numbers of `controller.law.relay`."""
        return laws.RelayGains(
            self.derivative_time, self.velocity, self.filter_time, scale.sample_period, limit=self.limit
        )


class OpenLoop(Base):
    """The reference is the spool reference itself, -1..1."""

    kind: Literal["open-loop"]

    @property
    def follows(self) -> bool:
        return False

    def gains(self, scale: Scale) -> laws.OpenLoopGains:
        """The numbers of `controller.law.open_loop`."""
        return laws.OpenLoopGains(self.limit)


class StateSpace(WithOverlap):
    """A sampled linear law: z <- A z + B u, spool = C z + D u."""

    NO_TACHOMETER: ClassVar[str] = (
        "controller.inputs 'velocity' needs a tachometer: set daq.tachometer = true, or read 'position' instead"
    )

    model_config = ConfigDict(json_schema_extra={"required": ["kind"]})  # the others may stand in a file

    kind: Literal["state-space"]
    file: str = Field(default="", exclude=True, description=FROM)
    A: Matrix = Field(default=[], description="n rows of n numbers; none for a law without memory")
    B: Matrix = Field(default=[], description="n rows, a column per input")
    C: Matrix = Field(default=[[]], description="one row of n numbers")
    D: Matrix = Field(description="one row, a number per input")
    dt: Seconds = Field(gt=0.0, description="sampling period that the matrices are for; equals loop.sample_period")
    inputs: list[Signal] = Field(default=["error"], min_length=1, description=READS)
    origin: Origin | None = Field(default=None, description="of the matrices, filled in when a file is read")

    @model_validator(mode="after")
    def _fits(self) -> "StateSpace":
        refuse_matrices(self.A, self.B, self.C, self.D, len(self.inputs))
        return self

    @property
    def needs_tachometer(self) -> bool:
        return "velocity" in self.inputs

    def refuse_period(self, period: float) -> None:
        if abs(self.dt - period) > SAME:
            raise ValueError(f"controller.dt {self.dt:g} s must equal loop.sample_period, {period:g} s")

    def gains(self, scale: Scale) -> StateSpaceGains:
        """The numbers of `controller.state_space.state_space`."""
        return StateSpaceGains(
            a=tuple(map(tuple, self.A)),
            b=tuple(map(tuple, self.B)),
            c=tuple(self.C[0]),
            d=tuple(self.D[0]),
            inputs=tuple(self.inputs),
            sample_period=scale.sample_period,
            limit=self.limit,
            overlap=self.jumped_share * scale.overlap,
        )


def _function(name: str) -> str:
    module, _, function = name.rpartition(":")
    if module and function.isidentifier():
        return name
    raise ValueError(f"{name!r} names no function; write module:function or FILE.py:function")


class Python(PdGains):
    """A function of your own, which is given the gains, and parameters of its own."""

    kind: Literal["python"]
    law: Annotated[str, AfterValidator(_function)] = Field(description="module:function or FILE.py:function")
    true_state: bool = Field(
        default=False, description="the law reads sample.true, the true state, which no real controller has"
    )
    parameters: Annotated[dict[str, Any], AfterValidator(parameters_of)] = Field(
        default={}, description="of the law, which reads gains.parameters.NAME; a text with a unit arrives in SI"
    )

    def gains(self, scale: Scale) -> laws.UserGains:
        """Those of `controller.law.pd`, and the parameters as plain numbers and words."""
        parameters = {name: parameter_in_si(value, scale) for name, value in self.parameters.items()}
        return laws.UserGains(*self._own(scale), parameters=parameters)

    @property
    def sees_truth(self) -> bool:
        return self.true_state

    @property
    def reads_channels(self) -> bool:
        return True

    @property
    def needs_tachometer(self) -> bool:
        return False


class InC(WithOverlap):
    """A function in C, whose header `hydrotwin messages --c` prints: a shared library, or a file that is compiled."""

    kind: Literal["c"]
    library: str = Field(default="", description="shared library beside the scenario, such as law.so")
    source: Annotated[str, AfterValidator(c_file)] = Field(
        default="", description="C file beside the scenario, compiled by the system's compiler; in place of library"
    )
    parameters: Annotated[dict[str, Any], AfterValidator(parameters_of), AfterValidator(only_numbers)] = Field(
        default={}, description="of the law, which gets them as numbers; a text with a unit arrives in SI"
    )

    @property
    def reads_channels(self) -> bool:
        return True

    @model_validator(mode="after")
    def _one_file(self) -> "InC":
        if bool(self.library) == bool(self.source):
            raise ValueError("give the law as controller.library or as controller.source, one of the two")
        return self

    def gains(self, scale: Scale) -> laws.CGains:
        """What the function is given beside sample and target."""
        parameters = {name: float(parameter_in_si(value, scale)) for name, value in self.parameters.items()}
        return laws.CGains(scale.sample_period, self.limit, self.jumped_share * scale.overlap, parameters)


AnyController = Pd | Pid | Relay | OpenLoop | StateSpace | Python | InC | Fmu
KINDS = by_kind(AnyController)
ONLY_SIGN = "a relay knows only the sign: give controller.derivative_time, the derivative over the gain [s]"
INSTEAD = {("relay", "gain"): ONLY_SIGN, ("relay", "derivative"): ONLY_SIGN}


def _spelled(value: Any) -> Any:
    """Plain data with their kind; ValueError for a law where the kind belongs."""
    if not isinstance(value, dict):
        return value
    value = with_kind(value)
    if "law" in value and value.get("kind") != "python":
        raise MisplacedError("law", _kind_of(str(value["law"])))
    return {"kind": "pd"} | value


def _kind_of(law: str) -> str:
    if law in KINDS:
        return f"{law!r} is a kind of controller; write controller.kind = {law!r}"
    if ":" in law:
        return f"{law!r} is a function of your own; write controller.kind = 'python' beside it"
    return f"{law!r} is unknown; write controller.kind{nearest(law, KINDS)}"


def changes_for(law: str) -> list[str]:
    """What makes a scenario's controller that of a kind, or a function of the user's."""
    return [f"controller.law={law}"] if ":" in law else [f"controller.kind={law}"]


Controller = Annotated[Annotated[AnyController, Field(discriminator="kind")], BeforeValidator(_spelled)]
