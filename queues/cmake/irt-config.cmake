# find_package(irt): the contract of a queue as `irt::queues`, irt_add_plugin() and, where it was
# built with virtual cores, irt_virtual_module() and irt_add_check().
include(CMakeFindDependencyMacro)
find_dependency(Threads)
include(${CMAKE_CURRENT_LIST_DIR}/irt-targets.cmake)
include(${CMAKE_CURRENT_LIST_DIR}/IrtPlugin.cmake)
if(EXISTS ${CMAKE_CURRENT_LIST_DIR}/micro.cpp.in)
  find_package(benchmark QUIET)
endif()

# Installed side by side: PREFIX/share/cmake/irt, PREFIX/include/irt, PREFIX/lib.../irt.
get_filename_component(irt_prefix ${CMAKE_CURRENT_LIST_DIR}/../../.. ABSOLUTE)
file(GLOB irt_runtime ${irt_prefix}/lib*/irt/libirt_virtual_cores.so
  ${irt_prefix}/lib/*/irt/libirt_virtual_cores.so)
find_program(IRT_OBJCOPY NAMES ${CMAKE_OBJCOPY} objcopy)
if(irt_runtime AND IRT_OBJCOPY AND NOT TARGET irt_virtual_cores)
  get_filename_component(irt_folder ${irt_runtime} DIRECTORY)
  add_library(irt_virtual_cores SHARED IMPORTED GLOBAL)
  set_target_properties(irt_virtual_cores PROPERTIES IMPORTED_LOCATION ${irt_runtime}
    IRT_REDIRECTIONS ${irt_folder}/redirected.syms IRT_ROOT ${irt_prefix}/include/irt
    IRT_PUBLIC ${irt_prefix}/include)
  if(EXISTS ${irt_folder}/irt-check)
    set(IRT_CHECK ${irt_folder}/irt-check)
  endif()
  add_library(irt_virtual_library STATIC IMPORTED GLOBAL)
  set_target_properties(irt_virtual_library PROPERTIES
    IMPORTED_LOCATION ${irt_folder}/libirt_virtual_library.a)
  if(EXISTS ${irt_folder}/libirt_counting.so)
    add_library(irt_counting SHARED IMPORTED GLOBAL)
    set_target_properties(irt_counting PROPERTIES
      IMPORTED_LOCATION ${irt_folder}/libirt_counting.so)
  endif()
  # GCC loads only plug-ins that were built for it.
  if(EXISTS ${irt_folder}/irt_announcer.so AND CMAKE_CXX_COMPILER_ID STREQUAL "GNU")
    add_library(irt_announcer MODULE IMPORTED GLOBAL)
    set_target_properties(irt_announcer PROPERTIES IRT_FILE ${irt_folder}/irt_announcer.so)
  endif()
  include(${CMAKE_CURRENT_LIST_DIR}/IrtVirtual.cmake)
endif()
unset(irt_runtime)
unset(irt_folder)
unset(irt_prefix)
