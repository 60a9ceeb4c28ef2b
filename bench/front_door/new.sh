# `irt new`: a queue of the user's own, outside the tree.

help_new() {
  cat <<'H'
Usage: irt new NAME [FOLDER]

Starts a queue outside the tree: a header that works and the CMakeLists.txt that builds it as a
plug-in. NAME is lower-case words joined by '-'; FOLDER, ./NAME by default, must not exist.
H
}

new_queue() {
  local name=${1:-} folder=${2:-${1:-}}
  case $name in -h | --help) help_new && return 0 ;; esac
  (($# == 1 || $# == 2)) || usage_error "new: takes a name and at most a folder; see 'irt help new'"
  [[ $name =~ ^[a-z][a-z0-9]*(-[a-z0-9]+)*$ ]] ||
    usage_error "new: '$name' is not a name; lower-case words joined by '-' are, like my-queue"
  [[ ! -e $folder ]] || usage_error "new: '$folder' is there already; name another folder"

  local build
  install_development || return 1
  folder=$(realpath -m -- "$folder")
  cmake -D NAME="$name" -D INTO="$folder" -P "$here/queues/cmake/new_queue.cmake" || return 1
  local irt header
  printf -v irt '%q' "$here/irt"
  printf -v header '%q' "$folder/${name//-/_}.hpp"
  printf -v build '%q' "$folder/build"
  cat <<N
Started the queue $name in $folder. It works as it is; each of these builds what it needs of it:

  $irt watch $header
  $irt check --queue $header
  $irt stress --queue $header
  $irt stress --sanitizer tsan --queue $header
  $irt compare --queue lfree,$header
  $irt bench contention --queue lfree,$header
  $irt bench micro --queue lfree,$header
  $irt bench counted --queue lfree,$header
  $irt bench instructions --queue lfree,$header
  $irt simulate --queue lfree,$header --cores 1..192
  $irt simulate --renderer --queue lfree,$header

Or build it as a plug-in of a project of your own:

  cmake -S $(printf %q "$folder") -B $build -D CMAKE_PREFIX_PATH=$(printf %q "$development")
  cmake --build $build
  $irt render --plugin $build/$name.so --queue $name
N
}
