# Code for virtual cores, in the tree and, installed, outside of it. Both have these targets:
# irt_virtual_cores, the runtime, with the properties IRT_ROOT (what #include is relative to),
# IRT_PUBLIC (where irt/explore.hpp is) and IRT_REDIRECTIONS (a file for objcopy);
# irt_virtual_library, what of the C++ library comes into a module; irt_announcer, where GCC's plug-in headers were there, with IRT_FILE.

# Compiles a target for virtual cores. What the code is told of the compiler and the machine stays as
# in any other build; -mcx16 lets Clang make calls of 16-byte atomics. Where a function returns is
# found by its frame pointer, which it still has if it does not end in a jump.
# With UNANNOUNCED it is without the plug-in, as where its headers are not installed.
function(irt_virtual_options target)
  get_target_property(root irt_virtual_cores IRT_ROOT)
  target_include_directories(${target} PRIVATE ${root})
  # Headers in place of the C++ library's own; what they hold depends on its version.
  if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU" AND CMAKE_CXX_COMPILER_VERSION MATCHES "^12\\.")
    target_include_directories(${target} BEFORE PRIVATE
      ${root}/stress/virtual_cores/library/headers)
  endif()
  set_target_properties(${target} PROPERTIES POSITION_INDEPENDENT_CODE ON)
  target_compile_options(${target} PRIVATE -gdwarf-4 -fsanitize=thread -U__SANITIZE_THREAD__
    "SHELL:-include ${root}/stress/virtual_cores/prelude.hpp"
    -ftls-model=global-dynamic -fno-omit-frame-pointer -fno-optimize-sibling-calls
    $<$<CXX_COMPILER_ID:GNU>:-Wno-tsan>
    $<$<CXX_COMPILER_ID:Clang>:-femulated-tls> $<$<CXX_COMPILER_ID:Clang>:-mcx16>
    $<$<CXX_COMPILER_ID:Clang>:-U__GCC_HAVE_SYNC_COMPARE_AND_SWAP_16>)
  # Calls that a compiler would expand into accesses which no hook announces.
  foreach(name memcpy memmove mempcpy memset memcmp memchr bcmp bzero strlen strnlen strcmp strncmp
      strcpy stpcpy strncpy strcat strncat strchr strrchr strstr)
    target_compile_options(${target} PRIVATE -fno-builtin-${name})
  endforeach()
  if(TARGET irt_announcer AND NOT "UNANNOUNCED" IN_LIST ARGN)
    get_target_property(plugin irt_announcer IRT_FILE)
    target_compile_options(${target} PRIVATE -fplugin=${plugin} -DIRT_VC_ANNOUNCER)
    get_target_property(sources ${target} SOURCES)
    set_property(SOURCE ${sources} APPEND PROPERTY OBJECT_DEPENDS ${plugin})
    get_target_property(imported irt_announcer IMPORTED)
    if(NOT imported)
      add_dependencies(${target} irt_announcer)
    endif()
  endif()
endfunction()

# irt_virtual_module(NAME SOURCES a.cpp ... [LINK library ...] [OPTIONS flag ...] [OUTPUT file]
#                    [EXPORTS symbol ...] [UNANNOUNCED])
#
# Compiles the sources for virtual cores into the shared object OUTPUT, by default
# ${CMAKE_CURRENT_BINARY_DIR}/NAME.so; the target is NAME, its property IRT_MODULE_FILE the path.
# Only what is named irt_* with C linkage is exported, and `main` as irt_main, by the linker's script IRT_EXPORTS.
function(irt_virtual_module name)
  cmake_parse_arguments(ARG "UNANNOUNCED" "OUTPUT" "SOURCES;LINK;OPTIONS;EXPORTS" ${ARGN})
  add_library(${name}_objects OBJECT EXCLUDE_FROM_ALL ${ARG_SOURCES})
  target_link_libraries(${name}_objects PRIVATE ${ARG_LINK})
  # Of a queue its plug-in is looked at; the rest is code that is wrong on purpose, or others'.
  set_target_properties(${name}_objects PROPERTIES CXX_CLANG_TIDY "")
  if(TARGET irt_options)
    target_link_libraries(${name}_objects PRIVATE irt_options)
  endif()
  set(unannounced)
  if(ARG_UNANNOUNCED)
    set(unannounced UNANNOUNCED)
  endif()
  irt_virtual_options(${name}_objects ${unannounced})
  # Frames once more, in other words so that CMake repeats them: whatever the caller's options say.
  target_compile_options(${name}_objects PRIVATE ${ARG_OPTIONS}
    "SHELL:-fno-omit-frame-pointer -fno-optimize-sibling-calls")
  get_target_property(redirections irt_virtual_cores IRT_REDIRECTIONS)
  set(file ${CMAKE_CURRENT_BINARY_DIR}/${name}.so)
  if(ARG_OUTPUT)
    set(file ${ARG_OUTPUT})
  endif()
  # Compiled libraries that the code needs; what they do is not seen.
  set(libraries)
  foreach(lib ${ARG_LINK})
    get_target_property(needed ${lib} INTERFACE_LINK_LIBRARIES)
    foreach(target ${lib} ${needed})
      if(TARGET ${target})
        get_target_property(type ${target} TYPE)
        if(type MATCHES "^(SHARED|STATIC|UNKNOWN)_LIBRARY$")
          list(APPEND libraries $<TARGET_FILE:${target}>)
        endif()
      endif()
    endforeach()
  endforeach()
  set(exports ${CMAKE_CURRENT_BINARY_DIR}/${name}.exports)
  # The numbers of a locale's facets are the library's own, of which there must be one each.
  set(exported "irt_*; _ZNSt*2idE;")
  foreach(symbol ${ARG_EXPORTS})
    string(APPEND exported " ${symbol};")
  endforeach()
  file(CONFIGURE OUTPUT ${exports} CONTENT "{ global: @exported@ local: *; };\n" @ONLY)
  # What has a function to export is linked with libraries that run natively. Templates that both have
  # stay apart, and what the code has allocated may be freed there.
  set(wanted ${ARG_EXPORTS})
  list(TRANSFORM wanted PREPEND -Wl,--undefined=)
  set(apart)
  if(ARG_EXPORTS)
    set(apart --remove-section=.group --wildcard --keep-global-symbol=main --keep-global-symbol=irt_*
      --keep-global-symbol=_ZNSt*2idE)
    list(APPEND wanted -Wl,--wrap=free -Wl,--wrap=_ZdlPv -Wl,--wrap=_ZdlPvm -Wl,--wrap=_ZdaPv)
  endif()
  # The objects linked into one, what the C library's names stand for renamed, and that linked again.
  # Its constructors are called by the runtime instead of the loader, so that they can be events; those
  # with a priority come first, as the loader would have it.
  set(constructors ${CMAKE_CURRENT_BINARY_DIR}/irt_constructors.ld)
  file(CONFIGURE OUTPUT ${constructors} CONTENT [[SECTIONS {
  irt_init_array : {
    KEEP(*(SORT_BY_INIT_PRIORITY(.init_array.*)))
    KEEP(*(.init_array))
  }
}
]])
  set(merged ${CMAKE_CURRENT_BINARY_DIR}/${name}.merged.o)
  set(renamed ${CMAKE_CURRENT_BINARY_DIR}/${name}.o)
  add_custom_command(OUTPUT ${file}
    COMMAND ${CMAKE_LINKER} -r -T ${constructors} -o ${merged} $<TARGET_OBJECTS:${name}_objects>
    COMMAND ${IRT_OBJCOPY} --redefine-syms=${redirections} --redefine-sym main=irt_main
      --redefine-sym main.cold=irt_main.cold ${apart}
            ${merged} ${renamed}
    COMMAND ${CMAKE_CXX_COMPILER} -shared -o ${file} ${renamed}
            -Wl,-z,now -Wl,-z,relro -Wl,-Bsymbolic-functions -Wl,--version-script=${exports} ${wanted}
            $<TARGET_FILE:irt_virtual_library> $<TARGET_FILE:irt_virtual_cores>
            -Wl,--start-group ${libraries} -Wl,--end-group
    DEPENDS ${name}_objects $<TARGET_OBJECTS:${name}_objects> irt_virtual_cores
            irt_virtual_library
    COMMAND_EXPAND_LISTS VERBATIM)
  add_custom_target(${name} DEPENDS ${file})
  set_target_properties(${name} PROPERTIES IRT_MODULE_FILE ${file} IRT_EXPORTS ${exports})
endfunction()

# irt_add_check(NAME SOURCES a.cpp ... [LINK library ...] [OPTIONS flag ...] [PROGRAM]
#               [ARGUMENTS word ...])
#
# Adds the CTest entry NAME. The sources are tests, in whatever framework, that explore
# (irt/explore.hpp), with the framework's library among LINK; ARGUMENTS are their main's. With PROGRAM
# they are a program instead, which is explored from its start to its end, and ARGUMENTS those of `irt
# check`.
function(irt_add_check name)
  cmake_parse_arguments(ARG "PROGRAM" "" "SOURCES;LINK;OPTIONS;ARGUMENTS" ${ARGN})
  if(NOT ARG_SOURCES)
    message(FATAL_ERROR "irt_add_check(${name}): no SOURCES")
  endif()
  if(NOT IRT_CHECK)
    message(FATAL_ERROR
      "irt_add_check(${name}): the irt that was found was installed without its checker; build the "
      "target irt-check and install again")
  endif()
  set(exports)
  set(run --tests)
  if(ARG_PROGRAM)
    set(run --program ${name} --module)
  else()
    set(exports EXPORTS main)
  endif()
  irt_virtual_module(${name} SOURCES ${ARG_SOURCES} LINK ${ARG_LINK} OPTIONS -O2 ${ARG_OPTIONS}
    ${exports})
  get_target_property(root irt_virtual_cores IRT_PUBLIC)
  target_include_directories(${name}_objects PRIVATE ${root})
  get_target_property(module ${name} IRT_MODULE_FILE)
  add_custom_target(${name}_module ALL DEPENDS ${name})
  set(separator)
  if(ARG_ARGUMENTS AND NOT ARG_PROGRAM)
    set(separator --)
  endif()
  add_test(NAME ${name} COMMAND ${IRT_CHECK} ${run} ${module} ${separator} ${ARG_ARGUMENTS})
endfunction()
