# What tests of the window share; they source it once `program` is set. A folder of their own, with settings of its own,
# where they stand, and which goes with the viewer (its process: `viewer`) when they end.
folder=$(mktemp -d)
viewer=
trap '[[ -z $viewer ]] || kill "$viewer" 2>/dev/null || true; rm -rf "$folder"' EXIT

test_name=$(basename "$0" .sh)
cd "$folder"
export XDG_CONFIG_HOME=$folder/config XDG_CACHE_HOME=$folder/cache

fail() { echo "$test_name: $1" >&2; tail -n 40 view.log >&2; exit 1; }
wait_for() {  # wait_for SECONDS WHAT COMMAND...: until the command succeeds
  local limit=$(($1 * 10)) what=$2
  shift 2
  for ((i = 0; i < limit; ++i)); do "$@" >/dev/null 2>&1 && return; sleep 0.1; done
  fail "no $what after $((limit / 10)) s"
}
