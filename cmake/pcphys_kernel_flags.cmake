# The flags under which kernel text gives the same bits everywhere, and the helper that hands them to a host.
#
#   pcphys_add_kernel(<target> <source>...)
#
# adds C++ sources that hold user kernels to <target> and compiles them so that their results match
# the GPU's bit for bit. `a * b + c` stays two rounded operations (-ffp-contract=off), and a project-wide
# -ffast-math is undone. -fno-math-errno and -fno-trapping-math change no value: they only let the compiler
# use the square-root instruction and vectorise selects. PCPHYS_EXACT tells write_kernel.h, which else refuses
# to compile where the processor has fused multiply-adds.
set(PCPHYS_KERNEL_FLAGS -fno-fast-math -ffp-contract=off -fno-math-errno -fno-trapping-math)
set(PCPHYS_USER_KERNEL_FLAGS ${PCPHYS_KERNEL_FLAGS} -DPCPHYS_EXACT)

function(pcphys_add_kernel target)
  if(NOT TARGET ${target})
    message(FATAL_ERROR "pcphys_add_kernel: there is no target '${target}'. Create it before adding kernels.")
  endif()
  foreach(source IN LISTS ARGN)
    get_filename_component(source ${source} ABSOLUTE)
    target_sources(${target} PRIVATE ${source})
    set_property(SOURCE ${source} TARGET_DIRECTORY ${target} APPEND PROPERTY COMPILE_OPTIONS ${PCPHYS_USER_KERNEL_FLAGS})
  endforeach()
endfunction()
