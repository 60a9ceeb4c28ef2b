# Writes FILES of the page into OUTPUT as strings: page.css becomes page_css.
set(text "#include \"bench/report/page_files.hpp\"\n\nnamespace irt::report {\n")
foreach(file ${FILES})
  get_filename_component(name ${file} NAME)
  string(REPLACE "." "_" name ${name})
  file(READ ${file} content)
  string(APPEND text "const char* const ${name} = R\"page-file(${content})page-file\";\n")
endforeach()
file(WRITE ${OUTPUT} "${text}}  // namespace irt::report\n")
