# oneTBB gives the threads of a step; without it steps run on the calling thread.
pcphys_find_optional(TBB PACKAGE TBB CALLED oneTBB DEBIAN libtbb-dev FOR "threads")

function(pcphys_link_tbb target)
  if(PCPHYS_HAVE_TBB)
    target_link_libraries(${target} PRIVATE TBB::tbb)
    target_compile_definitions(${target} PRIVATE PCPHYS_HAVE_TBB)
  endif()
endfunction()
