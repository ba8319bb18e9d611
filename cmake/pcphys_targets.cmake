# Rules shared by every target of this project.
set(PCPHYS_GENERATED ${PROJECT_BINARY_DIR}/generated)

if(CMAKE_SYSTEM_PROCESSOR MATCHES "^(x86_64|AMD64|amd64)$")
  set(PCPHYS_X86 TRUE)
else()
  set(PCPHYS_X86 FALSE)
endif()

# Language level, warnings, and no contraction: one fused multiply-add anywhere would end the equality with the GPU.
function(pcphys_own target)
  target_compile_features(${target} PRIVATE cxx_std_20)
  target_compile_options(${target} PRIVATE -Wall -Wextra -Wpedantic -Wno-psabi -ffp-contract=off)
  if(CMAKE_CXX_COMPILER_ID STREQUAL GNU AND CMAKE_CXX_COMPILER_VERSION VERSION_LESS 13)
    target_compile_options(${target} PRIVATE -Wno-restrict)  # GCC bug 105329: "a" + std::to_string(b) at -O3
  endif()
  if(PCPHYS_WERROR)
    target_compile_options(${target} PRIVATE -Werror)
  endif()
  if(PCPHYS_X86)
    target_compile_definitions(${target} PRIVATE PCPHYS_HAVE_X86_LANES)
  endif()
endfunction()

# Tests, benchmarks and scenes may look inside: they pin stages and kernels, not only the public API.
function(pcphys_sees_inside target)
  target_include_directories(${target} PRIVATE ${PROJECT_SOURCE_DIR} ${PROJECT_SOURCE_DIR}/src ${PCPHYS_GENERATED})
endfunction()

# Lanes of 4 and 8 exist on x86-64 only; elsewhere the scalar instantiations remain.
macro(pcphys_drop_foreign_lanes sources)
  if(NOT PCPHYS_X86)
    list(FILTER ${sources} EXCLUDE REGEX "/src/(cpu/kernels|collision/narrow)_[fd](1v|4|8v?)\\.cpp$")
  endif()
endmacro()

# With PCPHYS_KERNELS_FROM the kernels, which compile for minutes, are those of another build's library, and only the host code is
# compiled here: under sanitizers, and for fuzzers, in two minutes. The objects of kernels share no function with others
# (check_lane_objects.cmake), so both fit together, whatever their flags and compilers.
macro(pcphys_drop_kernels sources)
  if(PCPHYS_KERNELS_FROM)
    list(FILTER ${sources} EXCLUDE REGEX "/src/(cpu/kernels|collision/narrow)_[fd][148]v?\\.cpp$")
  endif()
endmacro()
function(pcphys_take_kernels target)
  if(PCPHYS_KERNELS_FROM)
    target_link_libraries(${target} PRIVATE ${PCPHYS_KERNELS_FROM})
  endif()
endfunction()

# One file per instantiation, each with the instruction set it may use; which one runs is chosen at run time.
# -mno-fma: a compiler driver that defaults to a newer processor must not bring fused operations back.
function(pcphys_set_lane_flags)
  foreach(name f1 f1v f4 f8 f8v d1 d1v d4)
    set(flags ${PCPHYS_KERNEL_FLAGS} $<$<NOT:$<CONFIG:Debug>>:-O3>)
    if(PCPHYS_X86 AND name STREQUAL f4)
      list(APPEND flags -msse4.2 -mno-fma)
    elseif(PCPHYS_X86 AND name MATCHES "^(f8|d4)$")
      list(APPEND flags -mavx2 -mno-fma)
    elseif(PCPHYS_X86 AND name MATCHES "v$")
      list(APPEND flags -mno-fma -mavx512f -mavx512vl -mavx512dq -mavx512bw)  # in this order: for Clang the first undoes the second
    endif()
    if(NOT name MATCHES "1$")
      list(APPEND flags -fno-sanitize=all)  # sanitizers watch the same text in f1 and d1; here it compiles for minutes
    endif()
    set_source_files_properties(${PROJECT_SOURCE_DIR}/src/cpu/kernels_${name}.cpp
      ${PROJECT_SOURCE_DIR}/src/collision/narrow_${name}.cpp PROPERTIES COMPILE_OPTIONS "${flags}")
  endforeach()
  set(flags ${PCPHYS_KERNEL_FLAGS} $<$<NOT:$<CONFIG:Debug>>:-O3>)
  foreach(name narrow_f narrow_d)
    set_source_files_properties(${PROJECT_SOURCE_DIR}/src/collision/${name}.cpp PROPERTIES COMPILE_OPTIONS "${flags}")
  endforeach()
endfunction()

# Writes kernel_texts.inl, which includes every kernel of the list, so that a new one needs no line in src/cpu.
function(pcphys_list_kernels)
  set(list ${PROJECT_SOURCE_DIR}/src/kernels/kernels.inl)
  set_property(DIRECTORY APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS ${list})
  file(STRINGS ${list} kernels REGEX "^PC_KERNEL\\(")
  set(texts "// Generated from src/kernels/kernels.inl.\n")
  foreach(kernel IN LISTS kernels)
    string(REGEX REPLACE "^PC_KERNEL\\(([A-Za-z0-9_]+),.*" "\\1" name "${kernel}")
    string(APPEND texts "namespace ${name} {\n#include \"kernels/${name}.inl\"\n}\n")
  endforeach()
  file(CONFIGURE OUTPUT ${PCPHYS_GENERATED}/kernel_texts.inl CONTENT "${texts}" @ONLY)  # written only when it changed
endfunction()

# Puts the text of the files into the program as `pcphys::NAME_source(file)`, declared in NAME.h, so that nothing has to
# be shipped beside it. The value of `out` is the generated source; any edit of a file regenerates it.
function(pcphys_embed out name)
  file(GLOB files CONFIGURE_DEPENDS ${ARGN})
  set(script ${PROJECT_SOURCE_DIR}/cmake/embed.cmake)
  set(output ${PCPHYS_GENERATED}/${name}.cpp)
  string(REPLACE ";" "|" joined "${files}")
  add_custom_command(OUTPUT ${output}
    COMMAND ${CMAKE_COMMAND} -DOUTPUT=${output} -DNAME=${name} -DFILES=${joined} -P ${script}
    DEPENDS ${files} ${script}
    WORKING_DIRECTORY ${PROJECT_SOURCE_DIR}
    COMMENT "Embedding ${name}" VERBATIM)
  file(WRITE ${PCPHYS_GENERATED}/${name}.h.new "#pragma once
#include <string_view>

namespace pcphys {
// Text of a file by its name (\"integrate.inl\"), or nullptr when there is none of that name.
const char* ${name}_source(std::string_view name);
}
")
  file(COPY_FILE ${PCPHYS_GENERATED}/${name}.h.new ${PCPHYS_GENERATED}/${name}.h ONLY_IF_DIFFERENT)
  set(${out} ${output} PARENT_SCOPE)
endfunction()

# One clear stop when a development package is missing, with the Debian package that brings it.
function(pcphys_require name package option)
  find_package(${name} QUIET ${ARGN})
  if(NOT ${name}_FOUND)
    message(FATAL_ERROR "pcphys: ${name} was not found. Install it (Debian, Ubuntu: apt-get install ${package}), "
      "run scripts/install-dependencies, or configure with -D${option}=OFF.")
  endif()
endfunction()

# tinygltf is used where it is found (PCPHYS_HAVE_TINYGLTF); nothing fails without it.
function(pcphys_link_tinygltf target)
  find_package(TinyGLTF QUIET CONFIG)
  if(TARGET TinyGLTF::TinyGLTF)
    target_link_libraries(${target} PRIVATE TinyGLTF::TinyGLTF)
    target_compile_definitions(${target} PRIVATE PCPHYS_HAVE_TINYGLTF)
  endif()
endfunction()
