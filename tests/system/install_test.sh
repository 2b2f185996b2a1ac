#!/bin/bash
# SPDX-License-Identifier: BSD-3-Clause
# install_test.sh BUILD: what `cmake --install` puts where, and what the Debian package says it needs.
set -euo pipefail
build=$(readlink -f "$1")
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
fail() {
  echo "install_test: $1" >&2
  exit 1
}

cmake --install "$build" --prefix "$work/usr" >"$work/log" 2>&1 || fail "$(tail -n 5 "$work/log")"
for program in robot_agent fusion_node operator_console; do
  "$work/usr/bin/$program" --version >"$work/said" || fail "$program does not run"
  cmp -s <("$build/bin/$program" --version) "$work/said" || fail "$program is another than the one that was built"
done
for file in bin/shoal-spy share/shoal/shoal_reader.py share/shoal/shoal_wire/message.py share/shoal/lcmtypes/shoal_edit_t.lcm \
  share/doc/shoal/copyright share/doc/shoal/operators.md share/doc/shoal/schemas/labels.schema.json \
  share/zsh/vendor-completions/_operator_console; do
  [ -s "$work/usr/$file" ] || fail "$file is missing"
done
"$work/usr/share/shoal/shoal_reader.py" --help >/dev/null || fail "the installed reader does not run"
completion=$work/usr/share/bash-completion/completions/operator_console
words=$(bash -c "source '$completion'; COMP_WORDS=(operator_console un); COMP_CWORD=1; _operator_console; echo \${COMPREPLY[@]}")
[[ " $words " == *" undo "* && " $words " == *" unlink "* ]] || fail "completion knows \"$words\""

(cd "$work" && cpack --config "$build/CPackConfig.cmake" -G DEB -B "$work/deb") >"$work/log" 2>&1 || fail "$(tail -n 5 "$work/log")"
deb=$(echo "$work"/deb/shoal_*.deb)
dpkg-deb -f "$deb" Depends | grep -q 'liblcm1' || fail "the package does not depend on liblcm1: $(dpkg-deb -f "$deb" Depends)"
dpkg-deb -c "$deb" >"$work/content"
grep -q ' ./usr/bin/operator_console$' "$work/content" || fail "the package holds no console"
if grep -qE ' ./usr/(include|lib)/' "$work/content"; then fail "the package holds more than programs and texts"; fi
echo "installed and packed: $(stat -c %s "$deb") bytes"
