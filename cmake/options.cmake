# How everything of ours is compiled.
add_library(promenade_options INTERFACE)
target_include_directories(promenade_options INTERFACE ${PROJECT_SOURCE_DIR})
target_compile_definitions(promenade_options INTERFACE
  PROMENADE_VERSION="${PROJECT_VERSION}" GLM_FORCE_SILENT_WARNINGS GLM_ENABLE_EXPERIMENTAL)
target_compile_options(promenade_options INTERFACE
  -Wall -Wextra -Wpedantic -Wshadow -Wconversion -Wsign-conversion -Wold-style-cast -Wnon-virtual-dtor -Woverloaded-virtual
  -Wnull-dereference -Werror
  # The same bytes from either compiler: no fused multiply-add behind our back, never -ffast-math.
  -ffp-contract=off
  # Every x86-64 since 2009; wider vectors are dispatched at run time (raster/).
  -march=x86-64-v2)
if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU")
  # g++ 12 reports these inside inlined standard containers where nothing is wrong.
  target_compile_options(promenade_options INTERFACE -Wno-null-dereference -Wno-stringop-overflow -Wno-array-bounds
    -Wno-stringop-overread -Wno-maybe-uninitialized -Wno-restrict)
endif()
if(PROMENADE_SANITIZE)
  target_compile_options(promenade_options INTERFACE -fsanitize=${PROMENADE_SANITIZE} -fno-omit-frame-pointer -fno-sanitize-recover=all)
  target_link_options(promenade_options INTERFACE -fsanitize=${PROMENADE_SANITIZE})
endif()
