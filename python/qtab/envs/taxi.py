"""``qtab/Taxi-v4``."""

from gymnasium.envs.toy_text.taxi import TaxiEnv as GymnasiumTaxiEnv

from qtab import _core


class TaxiEnv(_core.Taxi, GymnasiumTaxiEnv):
    """Gymnasium's Taxi stepping in Rust by its own table ``P``, its fickle passenger and its action mask included."""

    step_in_python = GymnasiumTaxiEnv.step
    action_mask_in_python = GymnasiumTaxiEnv.action_mask
