#!/usr/bin/env bash
# readme_scene.sh README COMPILER INCLUDE...: the scene of "Add a scene" compiles as it stands.
set -euo pipefail
readme=$1 compiler=$2
shift 2
work=$(mktemp -d)
trap 'rm -r "$work"' EXIT
sed -n '/^```cpp$/,/^```$/p' "$readme" | grep -v '^```' >"$work/scene.cpp"
name=$(sed -n 's/^SceneEntry \(.*\)() {$/\1/p' "$work/scene.cpp")
[[ -n $name ]] || { echo "no scene in $readme"; exit 1; }
cat >"$work/scene.hpp" <<END
#pragma once
#include "rbvi/core/scene.hpp"
namespace rbvi {
SceneEntry $name();
}
END
"$compiler" -std=c++20 -fsyntax-only -Wall -Wextra -Werror "${@/#/-I}" "$work/scene.cpp"
echo "the scene $name of $readme compiles"
