"""Controllers for tests."""


class Careful:
    """Turns if an obstacle is near."""

    def __init__(self, robot, settings):
        self.near = settings.number("near", 0.6, 0, 10)
        self.turn = settings.number("turn", 0.5, -2, 2)

    def step(self, input):
        least = input.newest("laser").values.min()
        return (0, 0, self.turn) if least < self.near else (0.1 * least, 0, 0)


class Divides:
    """Fails on its third call, for robot 7 only."""

    def __init__(self, robot, settings):
        self.left = 2 if robot.row == 7 else 1000

    def step(self, input):
        self.left -= 1
        return 1 / (self.left + 1), 0, 0


class Returns:
    """Returns the value of the setting."""

    def __init__(self, robot, settings):
        self.what = {"none": None, "two": (0, 0), "nan": (float("nan"), 0, 0), "text": "abc"}[settings.text("what", "two")]

    def step(self, input):
        return self.what


class Reads:
    """Fails in a module of Python's standard library."""

    def __init__(self, robot, settings):
        pass

    def step(self, input):
        import json
        return json.loads("]")


class Prints:
    """Prints at the end of the program, and has an error."""

    def __init__(self, robot, settings):
        import atexit
        if robot.row == 0:
            atexit.register(print, "farewell")
        self.calls = 0

    def step(self, input):
        self.calls += 1
        return 0, 0, 0

    def error(self):
        return float(self.calls)

    def done(self):
        return self.calls >= 3


class Ends:
    """Affects its process as the setting states, at 1 s, for robot 0 only."""

    def __init__(self, robot, settings):
        self.how, self.file, self.row = settings.text("how", ""), settings.text("file", ""), robot.row

    def step(self, input):
        if self.row == 0 and input.time > 0.95 and self.how:
            how, self.how = self.how, ""
            getattr(self, how)()
        return 0.1, 0, 0

    def exit(self):
        import os
        print("before the end", flush=True)
        os._exit(0)

    def system_exit(self):
        raise SystemExit(0)

    def loop(self):
        while True:
            pass

    def sleep(self):
        import time
        time.sleep(60)

    def child(self):
        import os
        import time
        if os.fork() == 0:
            with open(self.file, "w") as out:
                out.write(str(os.getpid()))
            time.sleep(600)
            os._exit(0)

    def escape(self):
        raise ValueError("\x1b[2Jgone")


class _Hidden:
    def step(self, input):
        return 0, 0, 0


class Gate:
    """Slides to and fro like test-slide of tests/control/plugin.cpp; `fault` chooses a mistake."""

    def __init__(self, model, settings):
        self.start, self.speed = model.pose.x, 0.0
        self.way = settings.number("way", 0.5, 0, 10)
        self.fault = settings.text("fault", "")

    def range(self):
        return "far" if self.fault == "range" else 5.0

    def tick(self, model):
        if model.time > 0.95 and self.fault == "divide":
            model.time / 0
        if self.fault == "pose":
            model.set_pose((float("nan"), 0, 0, 0))
        if self.fault == "late":
            Gate.kept = getattr(Gate, "kept", model)
            Gate.kept.set_present(False)
        gone = model.pose.x - self.start
        if gone >= self.way:
            self.speed = -0.5
        if gone <= 0.0:
            self.speed = 0.5
        model.set_velocity((self.speed, 0, 0))
        Gate.seen = [(robot.name, robot.row, robot.distance) for robot in model.robots]

    def contact(self, contact, model):
        Gate.touched = (contact.name, contact.row, contact.robot, contact.point)


class GateWithoutModel:
    def __init__(self):
        pass

    def tick(self, model):
        pass
