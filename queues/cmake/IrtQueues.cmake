# How a queue joins the testbed: one header, one line.
#
#   irt_add_queue(<name> <header> <class> [REQUIRES <imported target>... [PACKAGE <Debian package>]]
#                 [OPAQUE])
#
# registers the class template <class> of <header> (relative to the calling CMakeLists.txt) as the
# queue <name>. Where a required target does not exist the queue is off, with one status line.
# PACKAGE says whose code it is: that library's (global property IRT_THIRD_PARTY_QUEUES), so it is
# measured as the library is shipped, without assertions.
# OPAQUE says that some of its atomic operations are compiled code or inline assembly, which
# -fsanitize=thread does not see: such a queue is off in builds with ThreadSanitizer, where it would
# look like one large data race, and is not built for virtual cores (global property
# IRT_VISIBLE_QUEUES).
#
#   irt_library(<target> <header> [<library>...])
#
# makes the imported <target> of a library without a CMake package, if its header and the libraries
# named are found.
#
#   irt_queue_modules(<kind> <template> [LINK <target>...])
#
# compiles a source template once per registered queue into the module NAME.<kind>.so, or NAME.so for
# the kind `plugin` (queues/modules.hpp): the target irt_<kind>_<name>. The template may use
# @QUEUE_NAME@, @QUEUE_HEADER@ (as in #include "...") and @QUEUE_CLASS@. irt_queue_source makes the
# source alone. All modules stand in the folder that the global property IRT_QUEUE_MODULES names;
# irt_list_modules() writes there which there can be. The target irt-queues builds the plug-ins,
# irt-queue-modules all modules; what else a test opens, irt_use_modules() says.
#
# What links a queue's concrete type links the interface library `irt_queue_<name>`, or
# `irt_queue_headers` for all of them. The global property IRT_QUEUES lists the names in the order
# of registration, which is the order on the command line.

include(CheckCXXCompilerFlag)
include(optional_part)

function(irt_add_queue name header class)
  cmake_parse_arguments(PARSE_ARGV 3 ARG "OPAQUE" "PACKAGE" "REQUIRES")
  if(NOT name MATCHES "^[a-z][a-z0-9]*(-[a-z0-9]+)*$")
    message(FATAL_ERROR "queue '${name}': a name is lower-case words joined by '-'")
  endif()
  get_property(queues GLOBAL PROPERTY IRT_QUEUES)
  if(name IN_LIST queues)
    message(FATAL_ERROR "queue '${name}' is registered twice; names are unique")
  endif()
  cmake_path(ABSOLUTE_PATH header NORMALIZE)
  if(NOT EXISTS ${header})
    message(FATAL_ERROR "queue '${name}': no header ${header}")
  endif()
  foreach(target IN LISTS ARG_REQUIRES)
    if(NOT TARGET ${target})
      optional_part("queue ${name}" "${ARG_PACKAGE}" FALSE)
      return()
    endif()
  endforeach()
  if(ARG_PACKAGE)
    optional_part("queue ${name}" "${ARG_PACKAGE}" TRUE)
  endif()
  if(ARG_OPAQUE AND CMAKE_CXX_FLAGS MATCHES "-fsanitize=thread")
    message(STATUS "queue ${name}: off under ThreadSanitizer, which does not see its atomics")
    return()
  endif()

  cmake_path(RELATIVE_PATH header BASE_DIRECTORY ${PROJECT_SOURCE_DIR})
  set_property(GLOBAL APPEND PROPERTY IRT_QUEUES ${name})
  if(NOT ARG_OPAQUE)
    set_property(GLOBAL APPEND PROPERTY IRT_VISIBLE_QUEUES ${name})
  endif()
  if(ARG_PACKAGE)
    set_property(GLOBAL APPEND PROPERTY IRT_THIRD_PARTY_QUEUES ${name})
  endif()
  set_property(GLOBAL PROPERTY IRT_QUEUE_HEADER_${name} ${header})
  set_property(GLOBAL PROPERTY IRT_QUEUE_CLASS_${name} ${class})

  add_library(irt_queue_${name} INTERFACE)
  target_link_libraries(irt_queue_${name} INTERFACE irt_options Threads::Threads ${ARG_REQUIRES})
  if(NOT TARGET irt_queue_headers)
    add_library(irt_queue_headers INTERFACE)
  endif()
  target_link_libraries(irt_queue_headers INTERFACE irt_queue_${name})
endfunction()

function(irt_library target header)
  string(MAKE_C_IDENTIFIER "IRT_${target}" prefix)
  find_path(${prefix}_INCLUDE ${header})
  mark_as_advanced(${prefix}_INCLUDE)
  set(found ${${prefix}_INCLUDE})
  foreach(library IN LISTS ARGN)
    find_library(${prefix}_${library} ${library})
    mark_as_advanced(${prefix}_${library})
    list(APPEND found ${${prefix}_${library}})
  endforeach()
  if(NOT found MATCHES "NOTFOUND")
    add_library(${target} INTERFACE IMPORTED GLOBAL)
    list(POP_FRONT found include)
    target_include_directories(${target} INTERFACE ${include})
    target_link_libraries(${target} INTERFACE ${found})
  endif()
endfunction()

function(irt_queue_source template queue out_var)
  cmake_path(GET template STEM LAST_ONLY suffix)  # `plugin.cpp` of `plugin.cpp.in`
  set(QUEUE_NAME ${queue})
  get_property(QUEUE_HEADER GLOBAL PROPERTY IRT_QUEUE_HEADER_${queue})
  get_property(QUEUE_CLASS GLOBAL PROPERTY IRT_QUEUE_CLASS_${queue})
  set(source ${CMAKE_CURRENT_BINARY_DIR}/${queue}_${suffix})
  configure_file(${template} ${source} @ONLY)
  get_property(third_party GLOBAL PROPERTY IRT_THIRD_PARTY_QUEUES)
  if(queue IN_LIST third_party)
    set_property(SOURCE ${source} APPEND PROPERTY COMPILE_DEFINITIONS NDEBUG)
  endif()
  set(${out_var} ${source} PARENT_SCOPE)
endfunction()

set_property(GLOBAL PROPERTY IRT_QUEUE_MODULES ${PROJECT_BINARY_DIR}/queues/modules)
add_custom_target(irt-queues)
add_custom_target(irt-queue-modules)

# irt_note_module(<target> <file>): the target builds that file of the folder.
function(irt_note_module target file)
  set_property(GLOBAL APPEND_STRING PROPERTY IRT_QUEUE_MODULE_LIST "${file}\n")
  if(file MATCHES "^[^.]+\\.so$")
    add_dependencies(irt-queues ${target})
  endif()
  add_dependencies(irt-queue-modules ${target})
endfunction()

# irt_use_modules(<target> <kind> <queue>...): the target finds these modules built, of queues that
# there are.
function(irt_use_modules target kind)
  foreach(queue IN LISTS ARGN)
    if(TARGET irt_${kind}_${queue})
      add_dependencies(${target} irt_${kind}_${queue})
    endif()
  endforeach()
endfunction()

function(irt_list_modules)
  get_property(folder GLOBAL PROPERTY IRT_QUEUE_MODULES)
  get_property(list GLOBAL PROPERTY IRT_QUEUE_MODULE_LIST)
  file(CONFIGURE OUTPUT ${folder}/list.txt CONTENT "${list}")
endfunction()

# A shared object reaches its thread-locals as fast as a program does.
check_cxx_compiler_flag(-mtls-dialect=gnu2 IRT_HAS_TLS_DESCRIPTORS)

function(irt_queue_modules kind template)
  cmake_parse_arguments(PARSE_ARGV 2 ARG "" "" "LINK")
  get_property(queues GLOBAL PROPERTY IRT_QUEUES)
  get_property(folder GLOBAL PROPERTY IRT_QUEUE_MODULES)
  foreach(queue IN LISTS queues)
    irt_queue_source(${template} ${queue} source)
    set(target irt_${kind}_${queue})
    set(name ${queue}.${kind})
    if(kind STREQUAL plugin)
      set(name ${queue})
    endif()
    add_library(${target} MODULE ${source})
    set_target_properties(${target} PROPERTIES PREFIX "" OUTPUT_NAME ${name}
      LIBRARY_OUTPUT_DIRECTORY ${folder} CXX_VISIBILITY_PRESET hidden)
    target_link_libraries(${target} PRIVATE irt_queue_${queue} ${ARG_LINK})
    target_compile_options(${target} PRIVATE
      $<$<BOOL:${IRT_HAS_TLS_DESCRIPTORS}>:-mtls-dialect=gnu2>)
    irt_note_module(${target} ${name}.so)
  endforeach()
endfunction()
