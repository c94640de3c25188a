# Warnings are errors in every room; nothing outside the project sees these flags.
add_library(fogbench_warnings INTERFACE)
target_compile_options(fogbench_warnings INTERFACE
  -Wall -Wextra -Wpedantic -Wshadow -Wconversion -Wnon-virtual-dtor -Woverloaded-virtual
  -Wdouble-promotion -Wimplicit-fallthrough -Werror
  # A designated initialiser leaves the other members at their defaults on purpose.
  -Wno-missing-field-initializers)

# fogbench_sources_at_once(<target>) gives the compiler that many of the target's sources as one.
function(fogbench_sources_at_once target)
  if(FOGBENCH_SOURCES_AT_ONCE GREATER 1)
    set_target_properties(${target} PROPERTIES
      UNITY_BUILD ON UNITY_BUILD_BATCH_SIZE ${FOGBENCH_SOURCES_AT_ONCE})
  endif()
endfunction()

# fogbench_library(<folder> PUBLIC targets... PRIVATE targets...) declares the static library of one
# room, fogbench::<folder>: every source in it and below it, but main.cpp.
function(fogbench_library folder)
  cmake_parse_arguments(ARG "" "" "PUBLIC;PRIVATE" ${ARGN})
  file(GLOB_RECURSE sources CONFIGURE_DEPENDS *.cpp)
  list(REMOVE_ITEM sources ${CMAKE_CURRENT_SOURCE_DIR}/main.cpp)
  add_library(fogbench_${folder} STATIC ${sources})
  add_library(fogbench::${folder} ALIAS fogbench_${folder})
  target_include_directories(fogbench_${folder} PUBLIC ${PROJECT_SOURCE_DIR})
  target_link_libraries(fogbench_${folder}
    PUBLIC ${ARG_PUBLIC} PRIVATE ${ARG_PRIVATE} $<BUILD_INTERFACE:fogbench_warnings>)
  fogbench_sources_at_once(fogbench_${folder})
endfunction()

# fogbench_text(<folder> <file> <constant>) makes the header <folder>/<file>.hpp for the sources of a
# room: <constant> in it is the file's text, behind a line break.
function(fogbench_text folder file constant)
  set_property(DIRECTORY APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS ${file})
  file(READ ${file} text)
  configure_file(${PROJECT_SOURCE_DIR}/cmake/text.hpp.in
    ${PROJECT_BINARY_DIR}/made/${folder}/${file}.hpp @ONLY)
  target_include_directories(fogbench_${folder} PRIVATE ${PROJECT_BINARY_DIR}/made)
endfunction()

# fogbench_families(<folder>) makes the list of a room's effects, <folder>/effects/families.hpp: each
# file of <folder>/effects/catalogue/ defines those of one family, in a function of its own name.
function(fogbench_families folder)
  file(GLOB families RELATIVE ${CMAKE_CURRENT_SOURCE_DIR} CONFIGURE_DEPENDS effects/catalogue/*.cpp)
  foreach(file IN LISTS families)
    cmake_path(GET file STEM family)
    string(APPEND FAMILY_DECLARATIONS "Family ${family}();\n")
    string(APPEND FAMILY_NAMES "    ${family},\n")
  endforeach()
  configure_file(effects/families.hpp.in
    ${PROJECT_BINARY_DIR}/made/${folder}/effects/families.hpp @ONLY)
  target_include_directories(fogbench_${folder} PRIVATE ${PROJECT_BINARY_DIR}/made)
endfunction()

# fogbench_test(<name> SOURCES a_test.cpp ... LINKS targets... LABEL unit|system|slow COST seconds
# THREADS) declares one GoogleTest executable whose cases ctest runs one by one. THREADS, for what
# runs several, makes the label end in `_threads`. The target `quick_tests` builds what is not slow,
# `threads_tests` what has threads.
add_custom_target(quick_tests)
add_custom_target(threads_tests)
function(fogbench_test name)
  cmake_parse_arguments(ARG "THREADS" "LABEL;TIMEOUT;COST" "SOURCES;LINKS" ${ARGN})
  if(NOT ARG_LABEL)
    set(ARG_LABEL unit)
  endif()
  if(NOT ARG_TIMEOUT)
    set(ARG_TIMEOUT 120)
  endif()
  # The longest begin first, or one core waits for them in the end.
  if(NOT ARG_COST)
    set(ARG_COST 1)
  endif()
  add_executable(${name} ${ARG_SOURCES})
  target_include_directories(${name} PRIVATE ${PROJECT_SOURCE_DIR})
  target_link_libraries(${name} PRIVATE
    ${ARG_LINKS} fogbench_test_support GTest::gtest_main GTest::gmock fogbench_warnings)
  # Most of what a test does is in the rooms, and most of its build is the compiler's.
  target_compile_options(${name} PRIVATE -O0)
  fogbench_sources_at_once(${name})
  if(FOGBENCH_SOURCES_AT_ONCE GREATER 1)
    target_precompile_headers(${name} REUSE_FROM fogbench_test_headers)
  endif()
  if(NOT ARG_LABEL STREQUAL "slow")
    add_dependencies(quick_tests ${name})
  endif()
  if(ARG_THREADS)
    add_dependencies(threads_tests ${name})
    string(APPEND ARG_LABEL "_threads")  # ctest -L takes a part of a label
  endif()
  gtest_discover_tests(${name} DISCOVERY_MODE PRE_TEST NO_PRETTY_VALUES
    PROPERTIES LABELS "${ARG_LABEL}" TIMEOUT ${ARG_TIMEOUT} COST ${ARG_COST})
endfunction()
