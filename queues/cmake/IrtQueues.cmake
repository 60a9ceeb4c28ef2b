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
#   irt_for_each_queue(<template> <out-var> [QUEUES <name>...])
#
# instantiates a source template once per registered queue (or per queue named) and appends the
# generated files to <out-var>. The template may use @QUEUE_NAME@, @QUEUE_IDENTIFIER@ (the name with
# '_' for '-'), @QUEUE_HEADER@ (as in #include "...") and @QUEUE_CLASS@.
#
# What links a queue's concrete type links the interface library `irt_queue_<name>`, or
# `irt_queue_headers` for all of them. The global property IRT_QUEUES lists the names in the order
# of registration, which is the order on the command line.

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

function(irt_for_each_queue template out_var)
  cmake_parse_arguments(PARSE_ARGV 2 ARG "" "" "QUEUES")
  if(NOT ARG_QUEUES)
    get_property(ARG_QUEUES GLOBAL PROPERTY IRT_QUEUES)
  endif()
  cmake_path(GET template STEM LAST_ONLY suffix)  # `entry.cpp` of `entry.cpp.in`
  get_property(third_party GLOBAL PROPERTY IRT_THIRD_PARTY_QUEUES)
  set(sources ${${out_var}})
  foreach(QUEUE_NAME IN LISTS ARG_QUEUES)
    get_property(QUEUE_HEADER GLOBAL PROPERTY IRT_QUEUE_HEADER_${QUEUE_NAME})
    get_property(QUEUE_CLASS GLOBAL PROPERTY IRT_QUEUE_CLASS_${QUEUE_NAME})
    string(REPLACE "-" "_" QUEUE_IDENTIFIER ${QUEUE_NAME})
    set(source ${CMAKE_CURRENT_BINARY_DIR}/${QUEUE_IDENTIFIER}_${suffix})
    configure_file(${template} ${source} @ONLY)
    if(QUEUE_NAME IN_LIST third_party)
      set_property(SOURCE ${source} APPEND PROPERTY COMPILE_DEFINITIONS NDEBUG)
    endif()
    list(APPEND sources ${source})
  endforeach()
  set(${out_var} ${sources} PARENT_SCOPE)
endfunction()
