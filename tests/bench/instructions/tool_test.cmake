# irt-instructions as a program: the same figures every time, and those that the code has; without
# valgrind one line and code 2.
if(NOT VALGRIND)
  execute_process(COMMAND ${TOOL} --queue faa RESULT_VARIABLE code ERROR_VARIABLE said)
  if(NOT code EQUAL 2 OR NOT said MATCHES "^irt bench instructions: valgrind is missing[^\n]*\n$")
    message(FATAL_ERROR "without valgrind: exit code ${code}: ${said}")
  endif()
  return()
endif()

set(file ${CMAKE_CURRENT_BINARY_DIR}/instructions.json)
foreach(time 1 2)
  execute_process(COMMAND ${TOOL} --queue faa,lfree --operations 4000 --json ${file}
    OUTPUT_QUIET COMMAND_ERROR_IS_FATAL ANY)
  file(READ ${file} json)
  foreach(run 0 1)
    string(JSON count_${time}_${run} GET "${json}" ${run} instructions_per_operation)
    string(JSON functions LENGTH "${json}" ${run} functions)
    if(functions LESS 3)
      message(FATAL_ERROR "run ${run}: only ${functions} functions")
    endif()
  endforeach()
endforeach()
# faa: a push and a pop have one fetch-and-add each.
string(JSON locked GET "${json}" 0 locked_per_operation)
file(REMOVE ${file})
if(NOT locked EQUAL 1)
  message(FATAL_ERROR "faa: ${locked} locked operations instead of 1")
endif()
foreach(run 0 1)
  if(NOT count_1_${run} EQUAL count_2_${run})
    message(FATAL_ERROR "run ${run}: ${count_1_${run}} instructions, then ${count_2_${run}}")
  endif()
endforeach()

# With - nothing but JSON goes to standard output. Where nothing can be written nothing is measured.
execute_process(COMMAND ${TOOL} --queue faa --operations 200 --json -
  OUTPUT_VARIABLE json ERROR_QUIET COMMAND_ERROR_IS_FATAL ANY)
string(JSON value GET "${json}" 0 queue)
execute_process(COMMAND ${TOOL} --queue faa --json /proc/none/x RESULT_VARIABLE code
  OUTPUT_VARIABLE measured ERROR_VARIABLE said)
if(NOT code EQUAL 2 OR measured OR NOT said MATCHES "cannot be written")
  message(FATAL_ERROR "--json /proc/none/x: exit code ${code}: ${measured}${said}")
endif()
