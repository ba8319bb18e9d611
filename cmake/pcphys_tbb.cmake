# oneTBB gives the threads of a step; without it steps run on the calling thread.
set(PCPHYS_HAVE_TBB FALSE)
if(NOT PCPHYS_WITH_TBB STREQUAL OFF)
  find_package(TBB QUIET CONFIG)
  if(TBB_FOUND)
    set(PCPHYS_HAVE_TBB TRUE)
  elseif(NOT PCPHYS_WITH_TBB STREQUAL AUTO)
    message(FATAL_ERROR "pcphys: PCPHYS_WITH_TBB is ${PCPHYS_WITH_TBB} but oneTBB was not found. "
      "Install it (Debian, Ubuntu: apt-get install libtbb-dev) or configure with -DPCPHYS_WITH_TBB=OFF.")
  endif()
endif()
message(STATUS "pcphys: threads (oneTBB): ${PCPHYS_HAVE_TBB}")

function(pcphys_link_tbb target)
  if(PCPHYS_HAVE_TBB)
    target_link_libraries(${target} PRIVATE TBB::tbb)
    target_compile_definitions(${target} PRIVATE PCPHYS_HAVE_TBB)
  endif()
endfunction()
