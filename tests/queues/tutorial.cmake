# Does what docs/add-a-queue.md says, with the page's own text: section 3 in a copy of the tree if
# STEP is `inside`, section 4 if STEP is `outside`. SOURCE and BUILD are the project's folders, WORK
# is one to work in; COMPILER, FLAGS and LAUNCHER are those of the project's build; CHECK and SIMULATE
# are its tools on virtual cores, empty where there are none.
cmake_minimum_required(VERSION 3.25)

# text_of(<out-var> <info>): the text of the page's fenced block whose first line is ```<info>.
function(text_of out info)
  file(READ ${SOURCE}/docs/add-a-queue.md page)
  string(FIND "${page}" "```${info}\n" start)
  if(start EQUAL -1)
    message(FATAL_ERROR "docs/add-a-queue.md has no block '${info}'")
  endif()
  string(LENGTH "```${info}\n" length)
  math(EXPR start "${start} + ${length}")
  string(SUBSTRING "${page}" ${start} -1 page)
  string(FIND "${page}" "```" end)
  string(SUBSTRING "${page}" 0 ${end} page)
  set(${out} "${page}" PARENT_SCOPE)
endfunction()

function(run)
  execute_process(COMMAND ${ARGN} COMMAND_ERROR_IS_FATAL ANY)
endfunction()

set(options -G Ninja -DCMAKE_CXX_COMPILER=${COMPILER} -DCMAKE_CXX_FLAGS=${FLAGS}
  -DCMAKE_CXX_COMPILER_LAUNCHER=${LAUNCHER} -DCMAKE_BUILD_TYPE=Release)
text_of(header "cpp file=queues/blocking/spin_ring.hpp")
file(REMOVE_RECURSE ${WORK}/${STEP}/source)

if(STEP STREQUAL inside)
  set(tree ${WORK}/inside/source)
  file(COPY ${SOURCE}/CMakeLists.txt ${SOURCE}/queues DESTINATION ${tree})
  file(COPY ${SOURCE}/tests/CMakeLists.txt ${SOURCE}/tests/queues DESTINATION ${tree}/tests)
  file(WRITE ${tree}/queues/blocking/spin_ring.hpp "${header}")
  text_of(line "cmake insert=queues/CMakeLists.txt")
  file(READ ${tree}/queues/CMakeLists.txt list)
  string(REPLACE "\nirt_queue_modules(" "${line}\nirt_queue_modules(" list "${list}")
  file(WRITE ${tree}/queues/CMakeLists.txt "${list}")
  run(${CMAKE_COMMAND} -S ${tree} -B ${WORK}/inside/build ${options})
  run(${CMAKE_COMMAND} --build ${WORK}/inside/build --target queues_test)
else()
  set(project ${WORK}/outside/source)
  run(${CMAKE_COMMAND} --install ${BUILD} --component plugin --prefix ${WORK}/prefix)
  file(WRITE ${project}/spin_ring.hpp "${header}")
  text_of(list "cmake file=CMakeLists.txt")
  file(WRITE ${project}/CMakeLists.txt "${list}")
  run(${CMAKE_COMMAND} -S ${project} -B ${WORK}/outside/build ${options}
    -DCMAKE_PREFIX_PATH=${WORK}/prefix)
  run(${CMAKE_COMMAND} --build ${WORK}/outside/build)
  if(CHECK)
    set(plugin ${WORK}/outside/build/spin-ring.so)
    run(${CHECK} --plugin ${plugin} --shape E|D --shape ED|ED)
    run(${SIMULATE} --plugin ${plugin} --queue spin-ring,lock --cores 2 --time 0.01 --seeds 1
      --out ${WORK}/outside/simulated)
  endif()

  # The start that new_queue.cmake makes must build as it is.
  run(${CMAKE_COMMAND} -DNAME=brand-new -DINTO=${project}/new -P ${SOURCE}/queues/cmake/new_queue.cmake)
  run(${CMAKE_COMMAND} -S ${project}/new -B ${WORK}/outside/build_new ${options}
    -DCMAKE_PREFIX_PATH=${WORK}/prefix)
  run(${CMAKE_COMMAND} --build ${WORK}/outside/build_new)
endif()
