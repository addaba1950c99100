#!/usr/bin/env bash
# The window under real key and mouse events: moves, looks, takes a picture, records a path, quits. Needs a display of
# its own (xvfb-run) and xdotool.
# usage: xvfb-run -a tests/cli/viewer_events.sh PROGRAM [gl|cpu]
set -euo pipefail
program=$(realpath "$1")
folder=$(mktemp -d)
viewer=
trap '[[ -z $viewer ]] || kill "$viewer" 2>/dev/null || true; rm -rf "$folder"' EXIT
cd "$folder"
export XDG_CACHE_HOME=$folder/cache  # the user's stays as it is

fail() { echo "viewer_events: $1" >&2; cat view.log >&2; exit 1; }
wait_for() {  # wait_for SECONDS WHAT COMMAND...: until the command succeeds
  local limit=$(($1 * 10)) what=$2
  shift 2
  for ((i = 0; i < limit; ++i)); do "$@" >/dev/null 2>&1 && return; sleep 0.1; done
  fail "no $what after $((limit / 10)) s"
}
hold() { xdotool keydown "$1"; sleep "$2"; xdotool keyup "$1"; sleep 0.3; }

"$program" generate city --triangles 100000 -o city.glb 2>/dev/null
"$program" build city.glb -o city.prom 2>/dev/null
"$program" view city.prom --renderer "${2:-auto}" --size 640x360 --camera 20,20,2,45,0 2>view.log &
viewer=$!
wait_for 30 window xdotool search --name Promenade
sleep 1
hold r 0.5
hold w 1.5
xdotool mousemove 450 200 mousedown 1
sleep 0.5
for _ in 1 2 3 4 5; do xdotool mousemove_relative -- -20 -4; sleep 0.2; done
xdotool mouseup 1
sleep 0.3
hold space 1
hold r 0.5
wait_for 10 "recorded path" test -s path-0001.json
hold p 0.5
wait_for 10 picture test -s view-0001.png
hold Escape 0.5
wait_for 10 end bash -c "! kill -0 $viewer"
wait "$viewer" || fail "exit $?"
viewer=
python3 - <<'P'
import json
keys = json.load(open("path-0001.json"))["keys"]
first, last = keys[0], keys[-1]
forward = sum(b - a for a, b in zip(first["eye"][:2], last["eye"][:2]))
assert forward > 1, f"W moved the eye by {forward} m along x + y, looking that way"
assert last["eye"][2] > first["eye"][2] + 0.5, "space does not rise"
assert last["yaw_deg"] > first["yaw_deg"] + 10, "a drag to the left does not turn left"
assert last["pitch_deg"] > first["pitch_deg"] + 1, "a drag upwards does not look up"
P
echo "viewer_events: passed"
