# irt-tracer-bench as a program: with - nothing but JSON goes to standard output; where nothing can
# be written nothing is measured.
set(little --scene bunny --contestants "wide 8" --side 16 --threads 1 --repeats 1)
include(${CMAKE_CURRENT_LIST_DIR}/../json_option.cmake)
expect_json_alone("results;2" ${little})
expect_nothing_measured(${little})
