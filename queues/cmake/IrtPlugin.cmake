# irt_add_plugin(<name> <header> <class> [LINK <target>...] [SOURCES <file>...])
#
# builds the queue <class> of <header> (relative to the calling CMakeLists.txt) into a shared object
# <name>.so that every tool takes as `--plugin FILE` and then knows as the queue <name>. Beside it
# lie <name>.virtual.so, the same queue on virtual cores, for the checker and the simulator, and
# <name>.counted.so, which counts its atomic operations, and <name>.contention.so, by which it is
# measured under contention as its concrete type; they are left out where the irt that was found has
# none. It is the counterpart of irt_add_queue() for a queue that lives outside the tree;
# <header> needs no change to move from one to the other.
#
# SOURCES are further files of the queue, in C++ or C. All objects are compiled as the queues of the
# tree are, with -O2 and assertions, whatever the build type: figures compare.
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
  set(source ${CMAKE_CURRENT_BINARY_DIR}/${name}_plugin.cpp)
  configure_file(${CMAKE_CURRENT_FUNCTION_LIST_DIR}/plugin.cpp.in ${source} @ONLY)

  set(target irt_plugin_${name})  # not `name` alone, which may be `test` or `all`
  add_library(${target} MODULE ${source} ${ARG_SOURCES})
  set_target_properties(${target} PROPERTIES PREFIX "" OUTPUT_NAME ${name}
    CXX_VISIBILITY_PRESET hidden LINKER_LANGUAGE CXX)
  target_link_libraries(${target} PRIVATE irt::queues ${ARG_LINK})
  target_compile_options(${target} PRIVATE -O2 -UNDEBUG)
  if(EXISTS ${CMAKE_CURRENT_FUNCTION_LIST_DIR}/contention.cpp.in)
    set(measured ${CMAKE_CURRENT_BINARY_DIR}/${name}_contention.cpp)
    configure_file(${CMAKE_CURRENT_FUNCTION_LIST_DIR}/contention.cpp.in ${measured} @ONLY)
    set(contention irt_contention_plugin_${name})
    add_library(${contention} MODULE ${measured} ${ARG_SOURCES})
    set_target_properties(${contention} PROPERTIES PREFIX "" OUTPUT_NAME ${name}.contention
      CXX_VISIBILITY_PRESET hidden LINKER_LANGUAGE CXX)
    target_link_libraries(${contention} PRIVATE irt::queues ${ARG_LINK})
    target_compile_options(${contention} PRIVATE -O2 -UNDEBUG)
    add_dependencies(${target} ${contention})
  endif()
  set(has_virtual_cores FALSE)
  if(TARGET irt_virtual_cores)  # in the tree, plug-ins only serve tests on real threads
    get_target_property(has_virtual_cores irt_virtual_cores IMPORTED)
  endif()
  if(has_virtual_cores AND NOT CMAKE_CXX_FLAGS MATCHES "-fsanitize=")
    irt_virtual_module(irt_virtual_plugin_${name} SOURCES ${source} ${ARG_SOURCES}
      LINK irt::queues ${ARG_LINK}
      OPTIONS -O2 -UNDEBUG OUTPUT ${CMAKE_CURRENT_BINARY_DIR}/${name}.virtual.so)
    add_dependencies(${target} irt_virtual_plugin_${name})
    if(TARGET irt_counting)
      set(counted irt_counted_plugin_${name})
      add_library(${counted} MODULE $<TARGET_OBJECTS:irt_virtual_plugin_${name}_objects>)
      get_target_property(exports irt_virtual_plugin_${name} IRT_EXPORTS)
      set_target_properties(${counted} PROPERTIES PREFIX "" OUTPUT_NAME ${name}.counted
        LINKER_LANGUAGE CXX)
      target_link_options(${counted} PRIVATE -Wl,--version-script=${exports})
      target_link_libraries(${counted} PRIVATE irt_counting ${ARG_LINK})
      add_dependencies(${target} ${counted})
    endif()
  endif()
endfunction()
