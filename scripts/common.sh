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

# As many jobs as there are cores, but no more than fit into memory.
job_count() {
  local kb_each=$1 cores memory_kb
  cores=$(nproc)
  memory_kb=$(sed -n 's/^MemAvailable: *\([0-9]*\) kB/\1/p' /proc/meminfo)
  local fit=$((memory_kb / kb_each))
  [ "$fit" -ge 1 ] || fit=1
  say $((cores < fit ? cores : fit))
}

# with_progress WHAT LOG COMMAND...: runs COMMAND with its output in LOG, and shows how far it is
# from the "[3/70]" of ninja or the " 3/70 Test" of ctest: at most a line every tenth of the way
# and every three seconds, and a sign of life when nothing has been said for half a minute.
with_progress() {
  local what=$1 log=$2 status=0
  shift 2
  mkdir -p "$(dirname "$log")"
  : > "$log"
  "$@" < /dev/null 2>&1 | show_progress "$what" "$log" || status=$?
  return "$status"
}

show_progress() {
  local what=$1 log=$2 line part='' rest='' tenth shown=-1 at='' started=$SECONDS last=$SECONDS
  while :; do
    if IFS= read -r -t 10 part; then
      line=$rest$part
      rest=''
      printf '%s\n' "$line" >> "$log"
      if [[ $line =~ ^(\[|\ *)([0-9]+)/([0-9]+)(\]|\ Test) ]]; then
        at="${BASH_REMATCH[2]} of ${BASH_REMATCH[3]}"
        tenth=$((10 * BASH_REMATCH[2] / BASH_REMATCH[3]))
        if [ "$tenth" -eq 10 ] || { [ "$tenth" -gt "$shown" ] && [ $((SECONDS - last)) -ge 3 ]; }; then
          printf '  %s: %3d %% (%s, %d s)\n' "$what" $((10 * tenth)) "$at" $((SECONDS - started))
          shown=$tenth
          last=$SECONDS
        fi
      fi
    elif [ $? -le 128 ]; then  # the end, not the time-out
      break
    else
      rest+=$part
    fi
    if [ $((SECONDS - last)) -ge 30 ]; then
      printf '  %s: %s done, %d s\n' "$what" "${at:-nothing}" $((SECONDS - started))
      last=$SECONDS
    fi
  done
}
