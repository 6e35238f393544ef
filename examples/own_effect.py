"""An effect of one's own: every pad has a stiff skin. `loop --effect examples/own_effect.py` tries it."""

import numpy as np

from dummydesign.loop import Effect, Parameter, wrap


class Crust(Effect):
    """Elastic force + E x size x (1 - exp(-depth / 0.5 mm))."""

    name = "crust"
    hook = "pad"  # motion, pad, batch or sensor: where in the forward model it acts
    belongs_to = "pad"  # pad: it enters a design; rig or sensor: it stays in the laboratory
    shapes = ("slab",)  # the set-ups it is for; needs = ("temperature_C",) would ask for a column of every trial
    parameters = (Parameter("skin_mm2", "mm2", null=0.0, low=0.0, high=200.0, typical=5.0),)
    signature = "a step of force at contact that does not grow with depth"
    reference = "where the law comes from"

    def law(self, law, values):
        def crusted(depth_mm, thickness_mm):
            return law(depth_mm, thickness_mm) + values["skin_mm2"] * -np.expm1(-np.maximum(depth_mm, 0.0) / 0.5)

        return wrap(law, crusted)


if __name__ == "__main__":
    from dummydesign.loop import check_effect

    size = Crust.parameters[0]
    print(f"{Crust.name}: acts in the {Crust.hook}")
    print(f"size {size.name}: {size.low:g} to {size.high:g} {size.unit}")
    print("wrong with it:", check_effect(Crust) or "nothing")
