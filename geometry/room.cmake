# The same kernels on wider vectors; only processors that have them ever run these (geometry/triangle_kernels.cpp
# chooses).
if(CMAKE_SYSTEM_PROCESSOR MATCHES "x86_64|AMD64")
  set_source_files_properties(${PROJECT_SOURCE_DIR}/geometry/triangle_kernels_avx2.cpp PROPERTIES COMPILE_OPTIONS
    "-mavx2")
endif()
