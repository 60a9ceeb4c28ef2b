# irt-tracer-bench as a program: with - nothing but JSON goes to standard output; where nothing can
# be written nothing is measured.
set(little --scene bunny --contestants "wide 8" --side 16 --threads 1 --repeats 1)
execute_process(COMMAND ${TOOL} ${little} --json -
  OUTPUT_VARIABLE json ERROR_QUIET COMMAND_ERROR_IS_FATAL ANY)
string(JSON results LENGTH "${json}" results)
if(results LESS 3)
  message(FATAL_ERROR "only ${results} results")
endif()
execute_process(COMMAND ${TOOL} ${little} --json /proc/none/x RESULT_VARIABLE code
  OUTPUT_VARIABLE measured ERROR_VARIABLE said)
if(NOT code EQUAL 2 OR measured OR NOT said MATCHES "cannot be written")
  message(FATAL_ERROR "--json /proc/none/x: exit code ${code}: ${measured}${said}")
endif()
