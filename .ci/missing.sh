# shellcheck shell=bash
# Sourced by the scripts here. `missing WHAT` says what is not checked for want of a tool. With CI_REQUIRE_TOOLS=1, as in the workflows,
# it ends the script with exit 1 instead: a check that was meant to run has not run.
missing() {
  echo "*** $1 ***"
  [ "${CI_REQUIRE_TOOLS:-0}" != 1 ] || { echo "CI_REQUIRE_TOOLS=1: what is missing fails" >&2 && exit 1; }
}
