# Named checks that go on whatever comes of one, and what drivers need; for `source`, from the root of the repository.

failed=()

# Run one named check and go on whatever comes of it.
step() {
    local name=$1 start=$SECONDS result=passed
    shift
    echo "== $name"
    "$@" || { result=FAILED && failed+=("$name"); }
    echo "== $name: $result, $((SECONDS - start)) s"
}

# End, non-zero when a check failed.
finish() {
    if [ "${#failed[@]}" != 0 ]; then
        echo "FAILED: ${failed[*]}"
        exit 1
    fi
    echo "all passed, $SECONDS s"
}

# Run a command with one of the drivers of tools/drivers.sh and no other.
on_driver() {
    local folder=$PWD/target/drivers/$1
    shift
    VK_DRIVER_FILES=$folder/icd.json VK_ICD_FILENAMES=$folder/icd.json \
        LD_LIBRARY_PATH=$folder/lib${LD_LIBRARY_PATH:+:$LD_LIBRARY_PATH} "$@"
}
