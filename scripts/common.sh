# Sourced by the other scripts: the language of what they say, and how a long command shows that
# it is alive without flooding the terminal.

set -euo pipefail
export LC_ALL=C
cd "$(dirname "${BASH_SOURCE[0]}")/.."

say() { printf '%s\n' "$*"; }
fail() {
  printf '%s\n' "$*" >&2
  exit 1
}

# As many jobs as there are cores, but no more than fit into memory: the largest files (Ceres)
# take about 1.2 GB of it while they compile, twice that with sanitizers.
job_count() {
  local kb_each=$1 cores memory_kb
  cores=$(nproc)
  memory_kb=$(sed -n 's/^MemAvailable: *\([0-9]*\) kB/\1/p' /proc/meminfo)
  local fit=$((memory_kb / kb_each))
  [ "$fit" -ge 1 ] || fit=1
  say $((cores < fit ? cores : fit))
}

# with_progress WHAT LOG COMMAND...: runs COMMAND with its output in LOG, and shows how far it is
# from the "[3/70]" of ninja or the " 3/70 Test" of ctest, at most a line every tenth of the way
# and every three seconds.
with_progress() {
  local what=$1 log=$2 status=0 line tenth shown=-1 started=$SECONDS last=$SECONDS
  shift 2
  mkdir -p "$(dirname "$log")"
  : > "$log"
  "$@" < /dev/null 2>&1 | while IFS= read -r line; do
    printf '%s\n' "$line" >> "$log"
    if [[ $line =~ ^(\[|\ *)([0-9]+)/([0-9]+)(\]|\ Test) ]]; then
      tenth=$((10 * BASH_REMATCH[2] / BASH_REMATCH[3]))
      if [ "$tenth" -eq 10 ] || { [ "$tenth" -gt "$shown" ] && [ $((SECONDS - last)) -ge 3 ]; }; then
        printf '  %s: %3d %% (%d of %d, %d s)\n' "$what" $((10 * tenth)) \
          "${BASH_REMATCH[2]}" "${BASH_REMATCH[3]}" $((SECONDS - started))
        shown=$tenth
        last=$SECONDS
      fi
    fi
  done || status=$?
  return "$status"
}
