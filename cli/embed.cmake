# cmake -D OUT=file.cpp -D SCENE=file.toml -P embed.cmake: the scene that `cuboct bench` sizes, as C++ text.
file(READ ${SCENE} body)
file(WRITE ${OUT} "// SPDX-License-Identifier: MIT\n#include \"cli/bench_scene.h\"\n\nnamespace cuboct {\n
const char kBenchBlock[] = R\"scene~(${body})scene~\";\n\n}  // namespace cuboct\n")
