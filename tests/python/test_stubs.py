"""The type stubs contain exactly the public names."""

import ast
import os
import unittest

import sensorfarm


def public(names):
    return {name for name in names if not name.startswith("_")}


class Stubs(unittest.TestCase):
    def test_stubs(self):
        with open(os.path.join(os.path.dirname(sensorfarm.__file__), "__init__.pyi")) as file:
            body = ast.parse(file.read()).body
        classes = {node.name: node for node in body if isinstance(node, ast.ClassDef)}
        self.assertEqual(public(sensorfarm.__all__), public(
            set(classes) - {"Controller", "ModelController"} | {n.name for n in body if isinstance(n, ast.FunctionDef)} | {"NONE", "FLOOR"}))
        for name in ("SensorInfo", "Robot", "Reading", "Neighbour", "Light", "Input", "Settings", "Simulation", "Observations", "Worlds", "DeviceArray", "DeviceWorlds", "Model",
                     "ModelContact", "ModelSite", "NearRobot", "WorldObject"):
            bases = [classes[base.id] for base in classes[name].bases]
            stated = public(n.name for c in [classes[name], *bases] for n in c.body if isinstance(n, ast.FunctionDef))
            self.assertEqual(stated, public(dir(getattr(sensorfarm, name))), name)
        for name in ("Pose", "Twist"):
            fields = tuple(n.target.id for n in classes[name].body if isinstance(n, ast.AnnAssign))
            self.assertEqual(fields, getattr(sensorfarm, name)._fields)

    def test_simulations_members_are_described(self):
        for name in public(dir(sensorfarm.Simulation)):
            doc = getattr(sensorfarm.Simulation, name).__doc__
            self.assertGreater(len((doc or "").strip().splitlines()[-1]), 10, name)


if __name__ == "__main__":
    unittest.main()
