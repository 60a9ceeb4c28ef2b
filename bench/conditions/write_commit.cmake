# cmake -D SOURCE=dir -D OUTPUT=file -P write_commit.cmake
# Writes the commit that is being built; the file keeps its time stamp while the commit stays.
set(commit "unknown")
find_program(git git)
if(git)
  execute_process(COMMAND ${git} -C ${SOURCE} describe --always --dirty --abbrev=12 --exclude=*
    OUTPUT_VARIABLE answer OUTPUT_STRIP_TRAILING_WHITESPACE ERROR_QUIET RESULT_VARIABLE failed)
  if(NOT failed)
    set(commit "${answer}")
  endif()
endif()
set(text "#include \"bench/conditions/build_info.hpp\"\n\nconst char* const irt::build_commit = \"${commit}\";\n")
if(EXISTS ${OUTPUT})
  file(READ ${OUTPUT} old)
endif()
if(NOT "${old}" STREQUAL "${text}")
  file(WRITE ${OUTPUT} "${text}")
endif()
