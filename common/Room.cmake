# SPDX-License-Identifier: BSD-3-Clause
# A room is one directory under common/ and one static library, shoal::<room>. A file sees its own
# room and the rooms that room links, and nothing else: an undeclared dependency does not compile.
function(shoal_add_room)
  cmake_parse_arguments(ROOM "" "NAME" "SOURCES;HEADERS;PUBLIC;PRIVATE" ${ARGN})
  set(root ${PROJECT_BINARY_DIR}/rooms/${ROOM_NAME})
  file(MAKE_DIRECTORY ${root}/shoal)
  file(CREATE_LINK ${CMAKE_CURRENT_SOURCE_DIR} ${root}/shoal/${ROOM_NAME} SYMBOLIC)
  add_library(shoal_${ROOM_NAME} STATIC ${ROOM_SOURCES})
  add_library(shoal::${ROOM_NAME} ALIAS shoal_${ROOM_NAME})
  list(TRANSFORM ROOM_HEADERS PREPEND ${root}/shoal/${ROOM_NAME}/)
  target_sources(shoal_${ROOM_NAME} PUBLIC FILE_SET HEADERS BASE_DIRS ${root} FILES ${ROOM_HEADERS})
  # Where files are compiled together, they are included.
  set_target_properties(shoal_${ROOM_NAME} PROPERTIES
    UNITY_BUILD_CODE_BEFORE_INCLUDE "// NOLINTNEXTLINE(bugprone-suspicious-include)")
  target_link_libraries(shoal_${ROOM_NAME} PUBLIC ${ROOM_PUBLIC} shoal::base PRIVATE ${ROOM_PRIVATE})
endfunction()

# Compiles the target's files ten at a time: templates of json and CLI11 take most of each file's time. Names in anonymous
# namespaces must then differ within a target: in every room, for builds with sanitizers and clang-tidy do so with all.
function(shoal_compile_together target)
  set_target_properties(${target} PROPERTIES UNITY_BUILD ON UNITY_BUILD_BATCH_SIZE 10)
endfunction()

# shoal_add_test(NAME matching SOURCES a_test.cc ... LINK shoal::matching ... [TIMEOUT s] [LABELS l]
# [ENVIRONMENT K=V] [APART]): one executable of GoogleTest cases, each its own ctest entry with a time limit.
# Its files are compiled together, but for those of APART, which have names in common.
function(shoal_add_test)
  cmake_parse_arguments(TEST "APART" "NAME;TIMEOUT" "SOURCES;LINK;LABELS;ENVIRONMENT" ${ARGN})
  if(NOT TEST_TIMEOUT)
    set(TEST_TIMEOUT 120)
  endif()
  if(CMAKE_CXX_FLAGS MATCHES "-fsanitize")  # many times slower
    math(EXPR TEST_TIMEOUT "4 * ${TEST_TIMEOUT}")
  endif()
  set(properties TIMEOUT ${TEST_TIMEOUT})
  if(TEST_LABELS)
    list(APPEND properties LABELS ${TEST_LABELS})
  endif()
  if(TEST_ENVIRONMENT)
    list(APPEND properties ENVIRONMENT ${TEST_ENVIRONMENT})
  endif()
  add_executable(${TEST_NAME}_tests ${TEST_SOURCES})
  if(TEST_APART)
    set_target_properties(${TEST_NAME}_tests PROPERTIES UNITY_BUILD OFF)
  else()
    set_target_properties(${TEST_NAME}_tests PROPERTIES UNITY_BUILD ON)
  endif()
  target_link_libraries(${TEST_NAME}_tests PRIVATE ${TEST_LINK} shoal::base GTest::gtest_main)
  gtest_discover_tests(${TEST_NAME}_tests DISCOVERY_MODE PRE_TEST DISCOVERY_TIMEOUT 60
    TEST_PREFIX ${TEST_NAME}. PROPERTIES ${properties})
endfunction()
