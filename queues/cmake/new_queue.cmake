# cmake -DNAME=my-queue -DINTO=<folder> -P new_queue.cmake
#
# starts a queue outside the tree: <folder>/my_queue.hpp with the class MyQueue, which works, and the
# CMakeLists.txt that builds it as a plug-in. Overwrites nothing.
cmake_minimum_required(VERSION 3.25)

if(NOT NAME MATCHES "^[a-z][a-z0-9]*(-[a-z0-9]+)*$")
  message(FATAL_ERROR "queue '${NAME}': a name is lower-case words joined by '-'")
endif()
set(QUEUE_NAME ${NAME})
string(REPLACE "-" "_" QUEUE_FILE ${NAME})
set(QUEUE_CLASS "")
string(REPLACE "-" ";" words ${NAME})
foreach(word IN LISTS words)
  string(SUBSTRING ${word} 0 1 initial)
  string(SUBSTRING ${word} 1 -1 rest)
  string(TOUPPER ${initial} initial)
  string(APPEND QUEUE_CLASS ${initial}${rest})
endforeach()

set(template ${CMAKE_CURRENT_LIST_DIR}/../template)
foreach(file ${QUEUE_FILE}.hpp CMakeLists.txt)
  if(EXISTS ${INTO}/${file})
    message(FATAL_ERROR "${INTO}/${file} is there already; name another folder")
  endif()
endforeach()
configure_file(${template}/queue.hpp.in ${INTO}/${QUEUE_FILE}.hpp @ONLY)
configure_file(${template}/CMakeLists.txt.in ${INTO}/CMakeLists.txt @ONLY)
