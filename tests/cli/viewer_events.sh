#!/usr/bin/env bash
# The window under real key and mouse events: moves, looks, takes pictures, records a path and replays it, sets bookmarks
# and comes back to them, walks, goes to a click, shows the bird's eye, quits, remembers. Needs a display of its own
# (xvfb-run) and xdotool.
# usage: xvfb-run -a tests/cli/viewer_events.sh PROGRAM [gl|cpu]
set -euo pipefail
program=$(realpath "$1")
. "$(dirname "$0")/viewer_common.sh"
hold() { xdotool keydown "$1"; sleep "$2"; xdotool keyup "$1"; sleep 0.3; }

"$program" generate city --triangles 100000 -o city.glb 2>/dev/null
"$program" build city.glb -o city.prom 2>/dev/null
"$program" view city.prom --renderer "${2:-auto}" --size 640x360 --camera 20,20,2,45,0 2>view.log &
viewer=$!
wait_for 60 window xdotool search --name Promenade
# The first start measures both renderers before it takes keys: it does when a picture comes.
for _ in {1..120}; do xdotool key p; sleep 0.5; [[ -s view-0001.png ]] && break; done
sleep 1
rm -f view-*.png
hold r 0.5
hold w 1.5
xdotool mousemove 450 200 mousedown 1
sleep 0.5
for _ in 1 2 3 4 5; do xdotool mousemove_relative -- -20 -4; sleep 0.2; done
xdotool mouseup 1
sleep 0.3
hold space 1
xdotool keydown ctrl; hold 1 0.3; xdotool keyup ctrl  # bookmark 1: up here
hold r 0.5
wait_for 10 "recorded path" test -s path-0001.json
hold p 0.5
wait_for 10 picture test -s view-0001.png
hold r 0.5    # second path: replay, walk, bookmark, click, home
hold l 0.3
sleep 5
hold g 0.5
sleep 3       # falls to the ground
hold s 1
hold g 0.3
hold 1 0.5
sleep 1.5
xdotool mousemove 450 300 click 1 click 1
sleep 1.5
hold Home 0.5
sleep 1.5
hold r 0.5
wait_for 10 "second path" test -s path-0002.json
hold v 0.3
hold b 0.3
sleep 1
hold p 0.5
wait_for 10 "bird's picture" test -s view-0002.png
xdotool key Escape  # a tap shorter than a frame
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

def near(a, b, metres):
    return sum((p - q) ** 2 for p, q in zip(a["eye"], b["eye"])) ** 0.5 < metres
tour = json.load(open("path-0002.json"))["keys"]
assert any(near(k, first, 0.3) for k in tour), "L does not replay the recorded path from its beginning"
lowest = min(tour, key=lambda k: k["eye"][2])
assert 1 < lowest["eye"][2] < 3, f"on foot the eye is {lowest['eye'][2]} m high"
after = tour[tour.index(lowest):]
assert any(near(k, last, 0.01) for k in after), "1 does not go to the bookmark"
home = after[-1]
assert near(home, {"eye": [20, 20, 2]}, 0.01), f"Home ends at {home['eye']}"
settings = json.load(open("config/promenade/viewer.json"))
assert [*settings["bookmarks"].values()][0]["1"][0] == last["eye"][0], "the bookmark is not remembered"
P
cmp -s view-0001.png view-0002.png && fail "the bird sees what the walker sees"
echo "viewer_events: passed"
