#!/usr/bin/env bash
# [xiong1996]'s styles in the window: N goes from near and far to near alone, far alone, brute force and back; each shows
# another picture, and brute force nearly the first. The bird's eye shows the box. Needs a display of its own (xvfb-run)
# and xdotool. With FOLDER, the window is photographed there (ffmpeg).
# usage: xvfb-run -a tests/cli/viewer_far.sh PROGRAM [FOLDER]
set -euo pipefail
program=$(realpath "$1")
shots=${2:+$(realpath "$2")}
. "$(dirname "$0")/viewer_common.sh"
taken=0
picture() {  # of the view as it stands now
  ((++taken))
  for _ in {1..40}; do xdotool key p; sleep 0.5; compgen -G "view-*.png" >/dev/null && break; done >/dev/null
  sleep 0.5
  mv "$(compgen -G "view-*.png" | tail -1)" "picture-$1.png" || fail "no picture of $1"
  rm -f view-*.png
  [[ -z $shots ]] || ffmpeg -loglevel error -f x11grab -i "$DISPLAY" -frames:v 1 -y "$shots/$1.png"
}
hold() { xdotool keydown "$1"; sleep 0.4; xdotool keyup "$1"; sleep 1.5; }

"$program" generate city --triangles 100000 -o city.glb 2>/dev/null
"$program" build city.glb -o city.prom --cells none 2>/dev/null
python3 - <<'P'
import json
path = json.load(open("city_walk.json"))
path["keys"] = path["keys"][:1]
json.dump(path, open("start.json", "w"))
key = path["keys"][0]
print(",".join(str(v) for v in [*key["eye"], key["yaw_deg"], key["pitch_deg"]]), file=open("camera", "w"))
P
"$program" far city.prom --far-path start.json --far-box 60 --far-shells 2 >/dev/null 2>&1
"$program" view city.prom --renderer cpu --size 640x360 --camera "$(cat camera)" --policy stratified 2>view.log &
viewer=$!
wait_for 60 window xdotool search --name Promenade
picture wake
hold h  # the panel
sleep 2
picture full
hold n
picture near
hold n
picture far
hold n
picture brute
hold n
picture again
hold b
picture bird
xdotool key Escape
wait_for 10 end bash -c "! kill -0 $viewer"
wait "$viewer" || fail "exit $?"
viewer=
cmp -s picture-full.png picture-near.png && fail "near alone shows what both show"
cmp -s picture-full.png picture-far.png && fail "far alone shows what both show"
cmp -s picture-near.png picture-far.png && fail "near and far alone show the same"
cmp -s picture-full.png picture-bird.png && fail "the bird sees what the walker sees"
differing() { idiff -warn 0.25 -fail 0.25 -failpercent 100 "$1" "$2" | sed -n 's/.*(\([0-9.]*\)%) over.*/\1/p' | head -1 || true; }
same=$(differing picture-full.png picture-brute.png) near=$(differing picture-near.png picture-brute.png)
python3 -c "import sys; sys.exit(not ${same:-0} < ${near:-0})" || fail "brute force differs at ${same:-0} % of the pixels from near and far, at ${near:-0} % from near alone"
echo "viewer_far: passed; ${same:-0} % of the pixels differ from brute force, ${near:-0} % without far pictures"
