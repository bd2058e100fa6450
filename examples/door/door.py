"""The door of door.cpp in Python. In door.world write:  ctrl "door.py:Door speed=0.5" """

import math


class Door:
    def __init__(self, model, settings):
        self.closed, self.interval = model.pose, model.interval
        self.speed = settings.number("speed", 0.5, least=0.01, most=model.max_forward)
        self.way = settings.number("way", 1.0, least=0.01, most=10.0)
        self.reach = settings.number("reach", 1.2, least=0.0, most=10.0)
        self.hold = 0.0  # [s] until then it stays open

    def range(self):
        return self.reach + self.way

    def tick(self, model):
        near = any(self.from_closed(robot.pose) < self.reach for robot in model.robots)
        open = near or model.time < self.hold
        left = (self.way if open else 0.0) - self.from_closed(model.pose)  # [m] along its x
        model.set_velocity((max(-self.speed, min(self.speed, left / self.interval)), 0, 0))

    def contact(self, contact, model):
        """Opens again for a while after it touched a robot."""
        if contact.robot:
            self.hold = model.time + 2.0

    def from_closed(self, pose):
        """Distance [m] from the closed door."""
        x, y = pose.x - self.closed.x, pose.y - self.closed.y
        return math.sqrt(x * x + y * y)
