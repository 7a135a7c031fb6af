"""HTTP and WebSocket interface of a printer, in a separate thread with a real-time event loop."""
