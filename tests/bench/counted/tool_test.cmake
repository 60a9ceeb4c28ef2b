# irt-counted as a program: figures as JSON; a queue that cannot be counted ends in code 2, one line.
set(file ${CMAKE_CURRENT_BINARY_DIR}/counted.json)
execute_process(COMMAND ${TOOL} --queue lfree,cas --threads 1 --rounds 2 --seconds 0.02 --json ${file}
  OUTPUT_QUIET COMMAND_ERROR_IS_FATAL ANY)
file(READ ${file} json)
file(REMOVE ${file})
foreach(run 0 1)
  foreach(key kind queue threads operations_per_second plain_operations_per_second conditions
      retries_per_operation compare_exchanges_per_operation)
    string(JSON value GET "${json}" ${run} ${key})
  endforeach()
  string(JSON retries GET "${json}" ${run} retries_per_operation)
  if(NOT retries EQUAL 0)
    message(FATAL_ERROR "one thread lost compare-and-swaps: ${retries}")
  endif()
endforeach()

execute_process(COMMAND ${TOOL} --queue lfre RESULT_VARIABLE code ERROR_VARIABLE said)
if(NOT code EQUAL 2 OR NOT said MATCHES "^irt bench counted: [^\n]*'lfree'[^\n]*\n$")
  message(FATAL_ERROR "--queue lfre: exit code ${code}: ${said}")
endif()

include(${CMAKE_CURRENT_LIST_DIR}/../json_option.cmake)
expect_json_alone("0;queue" --queue cas --threads 1 --rounds 1 --seconds 0.005)
expect_nothing_measured(--queue cas --threads 1 --rounds 1 --seconds 0.005)
