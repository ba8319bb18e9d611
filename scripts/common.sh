# Sourced by the scripts beside this file.
root=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
cd "$root"

say() { printf '\n== %s\n' "$*"; }
fail() { printf '%s: %s\n' "$(basename "$0")" "$*" >&2; exit 1; }

# Under sudo the build belongs to the person who called, or their next build without sudo could not write it.
give_back() {
  if [ "$(id -u)" = 0 ] && [ -n "${SUDO_UID:-}" ] && [ -e "$root/build" ]; then
    chown -R "$SUDO_UID:${SUDO_GID:-$SUDO_UID}" "$root/build"
  fi
}
trap give_back EXIT

jobs=${PCPHYS_JOBS:-$(nproc 2>/dev/null || echo 2)}

# build <preset> [target]: configure once, then build all or that.
build() {
  local preset=$1
  if command -v ninja >/dev/null && [ -z "${CMAKE_GENERATOR:-}" ] && [ ! -f "build/$preset/CMakeCache.txt" ]; then
    export CMAKE_GENERATOR=Ninja
  fi
  # A build folder that came from another place is of no use here: CMake refuses it.
  if [ -f "build/$preset/CMakeCache.txt" ] && ! grep -qxF "CMAKE_HOME_DIRECTORY:INTERNAL=$root" "build/$preset/CMakeCache.txt"; then
    say "Removing build/$preset, which was configured in another folder"
    rm -rf "build/$preset"
  fi
  say "Configuring (preset $preset)"
  cmake --preset "$preset"
  say "Building with $jobs jobs"
  cmake --build "build/$preset" --parallel "$jobs" ${2:+--target "$2"}
}

# The first python3 on the path need not be the system's, which has the Debian package of matplotlib.
drawing_python() {
  local candidate
  for candidate in python3 /usr/bin/python3; do
    if "$candidate" -c 'import matplotlib' 2>/dev/null; then break; fi
  done
  echo "$candidate"
}
