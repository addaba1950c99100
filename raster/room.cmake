# One kernel, compiled three times: each file is the same template on another vector width, and only the processor that
# has the instructions ever runs it (raster/kernel.cpp chooses).
if(CMAKE_SYSTEM_PROCESSOR MATCHES "x86_64|AMD64")
  set(raster_avx2 "-mavx2;-mbmi;-mbmi2;-mlzcnt;-mpopcnt")
  if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU")
    # g++ 12's own _mm512_undefined_ps() is taken for a mistake where sanitizers keep it from being folded away.
    list(APPEND raster_avx2 "-Wno-uninitialized")
  endif()
  set_source_files_properties(${PROJECT_SOURCE_DIR}/raster/kernel_avx2.cpp PROPERTIES COMPILE_OPTIONS "${raster_avx2}")
  set_source_files_properties(${PROJECT_SOURCE_DIR}/raster/kernel_avx512.cpp PROPERTIES COMPILE_OPTIONS
    "${raster_avx2};-mavx512f;-mavx512bw;-mavx512dq;-mavx512vl;-mavx512cd;-mprefer-vector-width=512")
endif()
