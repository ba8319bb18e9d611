# FCL is a selectable narrow phase on the CPU and the oracle of the tests; the library works without it.
set(PCPHYS_HAVE_FCL FALSE)
if(NOT PCPHYS_WITH_FCL STREQUAL OFF)
  find_package(fcl QUIET CONFIG)
  if(fcl_FOUND)
    set(PCPHYS_HAVE_FCL TRUE)
  elseif(NOT PCPHYS_WITH_FCL STREQUAL AUTO)
    message(FATAL_ERROR "pcphys: PCPHYS_WITH_FCL is ${PCPHYS_WITH_FCL} but FCL was not found. "
      "Install it (Debian, Ubuntu: apt-get install libfcl-dev) or configure with -DPCPHYS_WITH_FCL=OFF.")
  endif()
endif()
message(STATUS "pcphys: FCL narrow phase: ${PCPHYS_HAVE_FCL}")

function(pcphys_link_fcl target)
  if(PCPHYS_HAVE_FCL)
    target_link_libraries(${target} PRIVATE fcl)
    target_compile_definitions(${target} PRIVATE PCPHYS_HAVE_FCL)
    # Headers of others are not ours to warn about.
    get_target_property(dirs fcl INTERFACE_INCLUDE_DIRECTORIES)
    if(dirs)
      target_include_directories(${target} SYSTEM PRIVATE ${dirs})
    endif()
  endif()
endfunction()
