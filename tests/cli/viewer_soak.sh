#!/usr/bin/env bash
# The window under random keys and drags for a while: no crash, no sanitizer's report, memory flat. Needs a display of
# its own (xvfb-run) and xdotool. The same keys for the same SEED (environment; 1).
# usage: xvfb-run -a tests/cli/viewer_soak.sh PROGRAM [SECONDS, 60] [MODEL, a small city built here]
set -euo pipefail
program=$(realpath "$1")
seconds=${2:-60}
model=${3:+$(realpath "$3")}
tests=$(realpath "$(dirname "$0")/..")
. "$tests/cli/viewer_common.sh"
RANDOM=${SEED:-1}
export TSAN_OPTIONS=suppressions=$tests/thread_suppressions.txt
export LSAN_OPTIONS=suppressions=$tests/leak_suppressions.txt:print_suppressions=0
export ASAN_OPTIONS=detect_odr_violation=0:verify_asan_link_order=0 UBSAN_OPTIONS=print_stacktrace=1

if [[ -z $model ]]; then
  "$program" generate city --triangles 200000 -o city.glb 2>/dev/null
  "$program" build city.glb -o city.prom 2>/dev/null
  model=city.prom
fi
preload=
if grep -q -e __asan_init -e __tsan_init "$program"; then
  # The OpenGL driver is unloaded before leaks are looked for, and what is said of it is nobody's then: it stays.
  echo 'int dlclose(void *library) { return library == 0; }' | cc -x c - -shared -fPIC -o stay.so
  preload=$PWD/stay.so
fi
LD_PRELOAD=$preload "$program" view "$model" --size 640x360 --camera 20,20,30,45,-20 --memory 64MiB 2>view.log &
viewer=$!
wait_for 60 window xdotool search --name Promenade
for _ in {1..120}; do xdotool key p; sleep 0.5; [[ -s view-0001.png ]] && break; done
keys=(w w w w s a d space c q e f g g b v h l r p Home 1 2 3 ctrl+1 ctrl+2 Up Down Left Right)
begin=$SECONDS
: >memory.txt
while ((SECONDS - begin < seconds)); do
  kill -0 "$viewer" 2>/dev/null || fail "the window is gone after $((SECONDS - begin)) s"
  key=${keys[RANDOM % ${#keys[@]}]}
  if ((RANDOM % 3 == 0)); then
    xdotool mousemove $((380 + RANDOM % 250)) $((40 + RANDOM % 300)) mousedown 1
    xdotool mousemove_relative -- $((RANDOM % 200 - 100)) $((RANDOM % 80 - 40))
    sleep 0.1
    xdotool mouseup 1 click $((RANDOM % 2 + 4))
  fi
  if [[ $key == ctrl+* ]]; then
    xdotool key "$key"
  else
    xdotool keydown "$key"; sleep "0.$((RANDOM % 9 + 1))"; xdotool keyup "$key"
  fi
  awk '/VmRSS/ {print $2}' "/proc/$viewer/status" >>memory.txt
done
xdotool key Escape
for ((i = 0; i < 300; ++i)); do kill -0 "$viewer" 2>/dev/null || break; sleep 0.1; done
status=0
wait "$viewer" || status=$?
viewer=
# Sanitizers keep what was freed for a while.
slack=1.02
grep -q -e __asan_init -e __tsan_init "$program" && slack=1.2
python3 - "$slack" <<'P'
import sys
rss = [int(line) / 1024 for line in open("memory.txt")]
third = len(rss) // 3
before, after = max(rss[third:2 * third]), max(rss[2 * third:])
print(f"viewer_soak: {len(rss)} events; resident at most {before:.0f} MiB in the second third, {after:.0f} MiB in the last")
assert after < before * float(sys.argv[1]) + 4, "memory grows"
P
((status == 0)) || fail "exit $status"
! grep -q "Sanitizer" view.log || fail "a sanitizer reports"
