# Writes a source that contains the files of a page as text: cmake -DOUT=file.cpp "-DFILES=a.js;b.css" -P WebFiles.cmake
set(rows "")
set(count 0)
foreach(file ${FILES})
  get_filename_component(name ${file} NAME)
  file(READ ${file} text)
  string(APPEND rows "    {\"${name}\", R\"--page--(${text})--page--\"},\n")
  math(EXPR count "${count} + 1")
endforeach()
file(WRITE ${OUT} "#include \"bridges/web_files.h\"

namespace sf::bridges {

const EmbeddedFile kEmbeddedFiles[] = {
${rows}};
const std::size_t kEmbeddedFileCount = ${count};

}  // namespace sf::bridges
")
