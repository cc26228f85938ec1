#!/usr/bin/env bash
# light_check.sh BUILDER PYTHON...: builds wheel and sdist twice (the same bytes), installs the wheel without
# extras with one Python of each version, and takes the example from its folder to temperatures and a diagnosis.
set -euo pipefail
builder=$1
shift
place=$(mktemp -d)
trap 'rm -rf "$place"' EXIT
for build in a b; do "$builder" -m hatchling build --directory "$place/$build" >/dev/null 2>&1; done
diff -r "$place/a" "$place/b"
cp -r docs/example "$place"
seen=""
for python in "$@"; do
  "$python" -c 'import sys; sys.exit(not (3, 11) <= sys.version_info[:2] <= (3, 14))' 2>/dev/null || continue
  version=$("$python" -c 'import sys; print(sys.version_info[:2])')
  [[ $seen != *"$version"* ]] || continue
  seen+=$version
  "$python" -m venv "$place/env"
  "$place/env/bin/pip" install --quiet --disable-pip-version-check "$place"/a/*.whl
  (
    cd "$place/example"
    "$place/env/bin/plasmapyro" correct my_test
    TIMEFORMAT="  diagnose: %R s, %U s of CPU"
    time "$place/env/bin/plasmapyro" diagnose my_test
    [ -s my_test_diagnosis/index.html ] && rm -r my_test_*
  )
  echo "$("$place/env/bin/python" --version): $(du -sm "$place/env" | cut -f1) MB installed, of these"
  du -sm "$place"/env/lib/python3.*/site-packages/* | sort -rn | sed -n '1,12s#/.*/##p' | paste -sd ' ' | expand -t 1
  rm -r "$place/env"
done
