# irt_add_plugin(<name> <header> <class> [LINK <target>...] [SOURCES <file>...])
#
# builds the queue <class> of <header> (relative to the calling CMakeLists.txt) into a shared object
# <name>.so that every tool takes as `--plugin FILE` and then knows as the queue <name>. Beside it
# lie <name>.virtual.so, the same queue on virtual cores, for the checker and the simulator,
# <name>.counted.so, which counts its atomic operations, and <name>.contention.so and <name>.micro.so,
# by which it is timed as its concrete type; those are left out which the irt that was found has not.
# It is the counterpart of irt_add_queue() for a queue that lives outside the tree; <header> needs no
# change to move from one to the other.
#
# SOURCES are further files of the queue, in C++ or C. All objects are compiled as the queues of the
# tree are, with -O2 and assertions, whatever the build type: figures compare.
include(CheckCXXCompilerFlag)
# A shared object reaches its thread-locals as fast as a program does.
check_cxx_compiler_flag(-mtls-dialect=gnu2 IRT_HAS_TLS_DESCRIPTORS)

function(irt_add_plugin name header class)
  cmake_parse_arguments(PARSE_ARGV 3 ARG "" "" "LINK;SOURCES")
  if(NOT name MATCHES "^[a-z][a-z0-9]*(-[a-z0-9]+)*$")
    message(FATAL_ERROR "plug-in '${name}': a name is lower-case words joined by '-'")
  endif()
  cmake_path(ABSOLUTE_PATH header NORMALIZE OUTPUT_VARIABLE QUEUE_HEADER)
  if(NOT EXISTS ${QUEUE_HEADER})
    message(FATAL_ERROR "plug-in '${name}': no header ${QUEUE_HEADER}")
  endif()
  set(QUEUE_NAME ${name})
  set(QUEUE_CLASS ${class})
  set(needed_by_micro benchmark::benchmark)
  foreach(kind plugin contention micro)
    set(template ${CMAKE_CURRENT_FUNCTION_LIST_DIR}/${kind}.cpp.in)
    if(NOT EXISTS ${template} OR (kind STREQUAL micro AND NOT TARGET benchmark::benchmark))
      continue()
    endif()
    set(source ${CMAKE_CURRENT_BINARY_DIR}/${name}_${kind}.cpp)
    configure_file(${template} ${source} @ONLY)
    set(target irt_${kind}_${name})  # not `name` alone, which may be `test` or `all`
    add_library(${target} MODULE ${source} ${ARG_SOURCES})
    set(file ${name}.${kind})
    if(kind STREQUAL plugin)
      set(file ${name})
    endif()
    set_target_properties(${target} PROPERTIES PREFIX "" OUTPUT_NAME ${file}
      CXX_VISIBILITY_PRESET hidden LINKER_LANGUAGE CXX)
    target_link_libraries(${target} PRIVATE irt::queues ${ARG_LINK} ${needed_by_${kind}})
    # Operations on 16 bytes are calls.
    target_link_options(${target} PRIVATE LINKER:--push-state,--as-needed,-latomic,--pop-state)
    target_compile_options(${target} PRIVATE -O2 -UNDEBUG
      $<$<BOOL:${IRT_HAS_TLS_DESCRIPTORS}>:-mtls-dialect=gnu2>)
  endforeach()

  set(has_virtual_cores FALSE)
  if(TARGET irt_virtual_cores)  # in the tree, plug-ins only serve tests on real threads
    get_target_property(has_virtual_cores irt_virtual_cores IMPORTED)
  endif()
  if(has_virtual_cores AND NOT CMAKE_CXX_FLAGS MATCHES "-fsanitize=")
    irt_virtual_module(irt_virtual_queue_${name} LINK irt::queues ${ARG_LINK}
      SOURCES ${CMAKE_CURRENT_BINARY_DIR}/${name}_plugin.cpp ${ARG_SOURCES}
      OPTIONS -O2 -UNDEBUG OUTPUT ${CMAKE_CURRENT_BINARY_DIR}/${name}.virtual.so)
    add_custom_target(irt_all_${name} ALL DEPENDS irt_virtual_queue_${name})
    if(TARGET irt_counting)
      set(counted irt_counted_${name})
      add_library(${counted} MODULE $<TARGET_OBJECTS:irt_virtual_queue_${name}_objects>)
      get_target_property(exports irt_virtual_queue_${name} IRT_EXPORTS)
      set_target_properties(${counted} PROPERTIES PREFIX "" OUTPUT_NAME ${name}.counted
        LINKER_LANGUAGE CXX)
      target_link_options(${counted} PRIVATE -Wl,--version-script=${exports})
      target_link_libraries(${counted} PRIVATE irt_counting ${ARG_LINK})
    endif()
  endif()
endfunction()
