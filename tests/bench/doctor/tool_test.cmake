# irt-doctor as a program: what --json prints is JSON and complete; a wrong option ends in code 2.
execute_process(COMMAND ${DOCTOR} --json OUTPUT_VARIABLE json COMMAND_ERROR_IS_FATAL ANY)
foreach(key cpu commit flags pinning)
  string(JSON value GET "${json}" conditions ${key})
endforeach()
string(JSON findings LENGTH "${json}" findings)
if(findings LESS 10)
  message(FATAL_ERROR "only ${findings} findings")
endif()

execute_process(COMMAND ${DOCTOR} --jsn RESULT_VARIABLE code ERROR_VARIABLE said)
if(NOT code EQUAL 2 OR NOT said MATCHES "--jsn")
  message(FATAL_ERROR "--jsn: exit code ${code}: ${said}")
endif()
