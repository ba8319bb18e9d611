# FCL is a selectable narrow phase on the CPU and the oracle of the tests; the library works without it.
pcphys_find_optional(FCL PACKAGE fcl CALLED FCL DEBIAN libfcl-dev FOR "narrow phase")

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
