# find_package(irt): the contract of a queue as `irt::queues`, and irt_add_plugin().
include(CMakeFindDependencyMacro)
find_dependency(Threads)
include(${CMAKE_CURRENT_LIST_DIR}/irt-targets.cmake)
include(${CMAKE_CURRENT_LIST_DIR}/IrtPlugin.cmake)
