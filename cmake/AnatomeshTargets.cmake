# Build settings shared by every target, and one function a kind of target.
include(GNUInstallDirs)

set(CMAKE_CXX_STANDARD 20)
set(CMAKE_CXX_STANDARD_REQUIRED ON)
set(CMAKE_CXX_EXTENSIONS OFF)
set(CMAKE_POSITION_INDEPENDENT_CODE ON)
set(CMAKE_EXPORT_COMPILE_COMMANDS ON)
set(CMAKE_RUNTIME_OUTPUT_DIRECTORY "${PROJECT_BINARY_DIR}/bin")
if(NOT CMAKE_BUILD_TYPE AND NOT CMAKE_CONFIGURATION_TYPES)
  set(CMAKE_BUILD_TYPE Release)
endif()

find_program(ANATOMESH_CCACHE ccache)
if(ANATOMESH_CCACHE AND NOT CMAKE_CXX_COMPILER_LAUNCHER)
  set(CMAKE_CXX_COMPILER_LAUNCHER "${ANATOMESH_CCACHE}")
endif()

# Results must not depend on the optimiser or the processor: no fused multiply-add contraction across expressions. Nobody
# asks for errno or floating-point traps, which keep loops from being vectorised.
add_library(anatomesh_settings INTERFACE)
target_compile_options(anatomesh_settings INTERFACE
  -Wall -Wextra -Wpedantic -Wshadow -Wconversion -ffp-contract=off -fno-math-errno -fno-trapping-math
  $<$<BOOL:${ANATOMESH_WARNINGS_AS_ERRORS}>:-Werror>)
if(ANATOMESH_SANITIZE)
  target_compile_options(anatomesh_settings INTERFACE
    -fsanitize=${ANATOMESH_SANITIZE} -fno-omit-frame-pointer -fno-sanitize-recover=all)
  target_link_options(anatomesh_settings INTERFACE -fsanitize=${ANATOMESH_SANITIZE})
endif()

# anatomesh_add_floor(NAME SOURCES ... DEPENDS ... PRIVATE_DEPENDS ...)
# One static library a folder of src/; DEPENDS are the folders below that it may include.
function(anatomesh_add_floor name)
  cmake_parse_arguments(A "" "" "SOURCES;DEPENDS;PRIVATE_DEPENDS" ${ARGN})
  add_library(anatomesh_${name} STATIC ${A_SOURCES})
  add_library(anatomesh::${name} ALIAS anatomesh_${name})
  target_include_directories(anatomesh_${name} PUBLIC
    "${PROJECT_SOURCE_DIR}/include" "${PROJECT_SOURCE_DIR}/src")
  target_link_libraries(anatomesh_${name} PUBLIC ${A_DEPENDS}
    PRIVATE anatomesh_settings ${A_PRIVATE_DEPENDS})
endfunction()

# anatomesh_add_library(TARGET NAME FLOORS ... LINKS ... PRIVATE_LINKS ...)
# A shared library for others, made of the objects of floors, which stay static within the build.
function(anatomesh_add_library target name)
  cmake_parse_arguments(A "" "" "FLOORS;LINKS;PRIVATE_LINKS" ${ARGN})
  set(objects)
  foreach(floor IN LISTS A_FLOORS)
    list(APPEND objects $<TARGET_OBJECTS:anatomesh_${floor}>)
  endforeach()
  add_library(${target} SHARED ${objects})
  set_target_properties(${target} PROPERTIES
    OUTPUT_NAME ${name} VERSION ${PROJECT_VERSION} SOVERSION ${PROJECT_VERSION_MAJOR}.${PROJECT_VERSION_MINOR}
    LINKER_LANGUAGE CXX)
  target_include_directories(${target} PUBLIC
    $<BUILD_INTERFACE:${PROJECT_SOURCE_DIR}/include> $<INSTALL_INTERFACE:${CMAKE_INSTALL_INCLUDEDIR}>)
  target_compile_features(${target} PUBLIC cxx_std_20)
  target_link_libraries(${target} PUBLIC ${A_LINKS} PRIVATE ${A_PRIVATE_LINKS})
  if(ANATOMESH_SANITIZE)
    target_link_options(${target} PRIVATE -fsanitize=${ANATOMESH_SANITIZE})
  endif()
endfunction()

# anatomesh_add_test(NAME SOURCES ... DEPENDS ... [TIMEOUT seconds])
# One GoogleTest program a tested folder, each case a ctest case.
function(anatomesh_add_test name)
  cmake_parse_arguments(A "" "TIMEOUT" "SOURCES;DEPENDS" ${ARGN})
  add_executable(test_${name} ${A_SOURCES})
  target_link_libraries(test_${name} PRIVATE
    anatomesh_settings ${A_DEPENDS} anatomesh_test_support GTest::gtest_main)
  if(NOT A_TIMEOUT)
    set(A_TIMEOUT 600)
  endif()
  gtest_discover_tests(test_${name} TEST_PREFIX "${name}." NO_PRETTY_VALUES DISCOVERY_TIMEOUT 120
    PROPERTIES TIMEOUT ${A_TIMEOUT})
endfunction()
