# optional_part(NAME PACKAGE FOUND): notes for `irt doctor` whether a part that rests on an optional
# library is on, and says so where it is off.
#     optional_part("queue tbb" libtbb-dev ${TBB_FOUND})
function(optional_part name package found)
  if(found)
    set(state true)
  else()
    set(state false)
    message(STATUS "${name}: off; ${package} switches it on")
  endif()
  set_property(GLOBAL APPEND_STRING PROPERTY IRT_OPTIONAL_PARTS
    "      {\"${name}\", \"${package}\", ${state}},\n")
endfunction()
