#!/bin/bash
# One emulated real robot and two virtual ones in processes of their own avoid each other and the walls of both worlds
# (docs/robots.md). Prints the contacts of each robot, and what the farm did with the real robot's own readings.
#
#   bash examples/rave/run.sh [SECONDS] [SEED]        PORT=9000 SENSORFARM=build/release/sensorfarm
set -eu
here=$(dirname "$0")
program=${SENSORFARM:-sensorfarm}
seconds=${1:-60}
seed=${2:-1}
port=${PORT:-9000}
out=$(mktemp -d)
trap 'kill $(jobs -p) 2>/dev/null || true; rm -r "$out"' EXIT

"$program" serve "$here/virtual.world" --port "$port" --seed "$seed" --duration $((seconds + 3)) --json >"$out/farm.json" &
sleep 1
robot() {
  name=$1
  shift
  "$program" robot "$here/virtual.world" --name "$name" --port "$port" --seed "$((seed + $1))" --duration "$seconds" \
    --controller wander --set speed=0.2 --set check_sweep=true --json "${@:2}" >"$out/$name.json" &
}
robot real 1000 --real-world "$here/real.world"
sleep 0.3
robot anna 2000
sleep 0.2
robot ben 3000
wait

python3 - "$out" <<'PYTHON'
import json, sys
for name in ("real", "anna", "ben"):
    robot = json.load(open("%s/%s.json" % (sys.argv[1], name)))
    print("%s: %d contacts, %.1f m driven" % (name, robot["contacts"], robot["distance_m"]))
print("own readings:", json.load(open(sys.argv[1] + "/farm.json"))["own_readings"])
PYTHON
