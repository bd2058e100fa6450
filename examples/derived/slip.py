"""The derived sensor of slip.cpp in Python: the turn rate by which encoders and gyro disagree, which shows slip.

    SENSORFARM_PLUGINS=slip.py sensorfarm run slip.world --duration 5
"""


class Slip:
    name = "slip"  # `type` in world files
    id = 15
    columns = {"slip_rad_s": 1e-6}  # with the resolution of packets
    ports = {"wheels": ("left_m", "right_m"), "gyro": ("rate_rad_s",)}
    keys = ("track",)

    def __init__(self, site, settings):
        self.ports = [each.port for each in site.inputs]
        self.track = settings.length("track", 0.258, 0.01, 10.0)
        self.before = self.wheels = self.gyro = None

    def take(self, input, reading):
        if self.ports[input] == "gyro":
            self.gyro = reading.values[0]
            return
        left, right = reading.values[0][:2]
        now = (reading.time, (right - left) / self.track)  # [s], [rad] by the wheels
        if self.before:
            self.wheels = (now[1] - self.before[1]) / (now[0] - self.before[0])
        self.before = now

    def read(self, time):
        if self.wheels is None or self.gyro is None:
            return None  # not valid
        return [self.wheels - self.gyro]
