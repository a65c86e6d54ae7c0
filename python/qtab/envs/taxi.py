"""``qtab/Taxi-v4``."""

from gymnasium.envs.toy_text.taxi import TaxiEnv as GymnasiumTaxiEnv

from qtab import _core
from qtab.envs.toy_text import RustReset


class TaxiEnv(_core.Taxi, RustReset, GymnasiumTaxiEnv):
    """Gymnasium's Taxi stepping in Rust by its own table ``P``, its fickle passenger and its action mask included."""

    reset_in_python = GymnasiumTaxiEnv.reset
    step_in_python = GymnasiumTaxiEnv.step
    action_mask_in_python = GymnasiumTaxiEnv.action_mask
