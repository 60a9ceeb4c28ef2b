# expect_json_alone(<path in it> <argument>...): with --json - nothing but JSON, which has something
# at <path>, comes from ${TOOL} on standard output.
# expect_nothing_measured(<argument>...): where --json cannot be written it measures nothing.
function(expect_json_alone path)
  execute_process(COMMAND ${TOOL} ${ARGN} --json -
    OUTPUT_VARIABLE json ERROR_QUIET COMMAND_ERROR_IS_FATAL ANY)
  string(JSON found ERROR_VARIABLE wrong GET "${json}" ${path})
  if(wrong)
    message(FATAL_ERROR "--json -: ${wrong}: ${json}")
  endif()
endfunction()

function(expect_nothing_measured)
  execute_process(COMMAND ${TOOL} ${ARGN} --json /proc/none/x RESULT_VARIABLE code
    OUTPUT_VARIABLE measured ERROR_VARIABLE said)
  if(NOT code EQUAL 2 OR measured OR NOT said MATCHES "cannot be written")
    message(FATAL_ERROR "--json /proc/none/x: exit code ${code}: ${measured}${said}")
  endif()
endfunction()
