// Everything in its place, then the instant that the address names (`#t=42.5`), or the one in
// which the tree ended.

function seekAddress() {
  const wanted = /^#t=([\d.]+)$/.exec(window.location.hash);
  seek(wanted ? tickAt(Number(wanted[1])) : record.end);
}

showHead();
showTimeline();
showTree();
showFloor();
showCamera();
showBoard();
showFailures();
showSource();
obeyKeys();
seekAddress();
window.addEventListener("hashchange", seekAddress);
if (record.about.ended === "FAILURE" && failureItems.length) chooseFailure(failureItems.length - 1);
